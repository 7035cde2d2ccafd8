//! Same input, same bits: whatever the threads, whatever room the lists had at the start.

use rockfall::glam::Vec3;
use rockfall::{
    Backend, BroadPhase, Capsule, Cuboid, Integrator, Options, Polygon, Report, Rod, Scene, Simulation, Sphere, SphereId,
    SphereState, Spring, Tether,
};

#[macro_use]
mod common;

use common::*;

/// Something of every kind, falling into a walled place: loose spheres, a chain on a fixed sphere, capsules, a springy
/// triangle, a tether; so that there are collisions, contacts, rods on everything, and lengths to hold.
fn mixed(balls: usize) -> Scene {
    let mut scene = with(|settings| settings.gravity = 10.0);
    floor_box(&mut scene);
    for (corner, left, right) in [
        ([-1.5, 0.0, -1.5], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]),
        ([1.5, 0.0, -1.5], [0.0, 0.0, 3.0], [0.0, 4.0, 0.0]),
        ([-1.5, 0.0, -1.5], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]),
    ] {
        scene.add_polygon(Polygon::new(corner, left, right)).expect("a valid polygon");
    }
    scene.add_box(Cuboid::between([-1.5, 0.0, 1.5], [1.5, 4.0, 2.5])).expect("a valid box");
    for ball in 0..balls {
        let (column, layer) = (ball % 16, ball / 16);
        let place = Vec3::new((column % 4) as f32 * 0.6, layer as f32 * 0.52, (column / 4) as f32 * 0.6);
        let jitter = 0.05 * Vec3::new((ball as f32).sin(), 0.0, (ball as f32 * 1.7).cos());
        let radius = 0.2 + 0.05 * (ball as f32 * 0.9).sin();
        let ball = Sphere::new(place + jitter + Vec3::new(-0.9, 0.3, -0.9), radius).mass(1.0 + layer as f32);
        scene.add_sphere(ball.velocity([0.0, -2.0, 0.0])).expect("a valid sphere");
    }
    let top = 0.5 + 0.52 * balls.div_ceil(16) as f32;
    add_chain(&mut scene, top);
    add_triangle(&mut scene, top + 0.6);
    for (x, z) in [(-0.8, -0.6), (0.3, 0.7), (0.9, -0.9)] {
        let end = Vec3::new(x, top + 1.2, z);
        let capsule = Capsule::new(end, end + Vec3::new(0.4, 0.2, -0.3), 0.15).velocity([0.0, -3.0, 0.0]);
        scene.add_capsule(capsule).expect("a valid capsule");
    }
    scene
}

/// Five links on a fixed sphere, through the middle of the place.
fn add_chain(scene: &mut Scene, height: f32) {
    let links: Vec<SphereId> = (0..6)
        .map(|link| {
            let mut sphere = Sphere::new([-1.2 + 0.4 * link as f32, height, 0.1], 0.1);
            sphere.fixed = link == 0;
            scene.add_sphere(sphere).expect("a valid sphere")
        })
        .collect();
    for pair in links.windows(2) {
        scene.add_rod(Rod::new(pair[0], pair[1], 0.05).length(0.4)).expect("a valid rod");
    }
}

/// Three spheres, three springs, one of the sides a rod of free length as well, one corner tethered.
fn add_triangle(scene: &mut Scene, height: f32) {
    let corners = [[0.0, height, 0.0], [0.6, height, 0.0], [0.3, height, 0.5]].map(|corner| Sphere::new(corner, 0.12));
    let corners = spheres(scene, corners);
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let spring = Spring::new(corners[a], corners[b], 200.0, 0.6).damping(1.0);
        scene.add_spring(spring).expect("a valid spring");
    }
    scene.add_rod(Rod::new(corners[0], corners[1], 0.1)).expect("a valid rod");
    let tether = Tether::new(corners[2], [0.0, height + 0.5, 0.0], 20.0);
    scene.add_tether(tether).expect("a valid tether");
}

struct Run {
    spheres: Vec<SphereState>,
    report: Report,
}

/// Steps of 10 ms, in which a lot must have happened.
fn run(options: Options, steps: u64, balls: usize) -> Run {
    let mut simulation = Simulation::with_options(mixed(balls), options).expect("the simulation opens");
    let report = simulation.run(steps, 0.01).expect("steps");
    assert!(report.total_collisions > 10 && report.contacts > 10, "{report:?}");
    let spheres = simulation.spheres().expect("spheres are read back");
    Run { spheres, report }
}

/// Equal to the last bit: `==` on floats would take 0 for -0 and miss equal NaNs.
#[track_caller]
fn same_bits(one: &Run, other: &Run) {
    let bits = |run: &Run| -> Vec<Vec<u32>> {
        let of = |sphere: &SphereState| {
            let vectors = [sphere.position, sphere.velocity, sphere.angular_momentum];
            let numbers = vectors.iter().flat_map(Vec3::to_array).chain(sphere.orientation.to_array());
            numbers.map(f32::to_bits).collect()
        };
        run.spheres.iter().map(of).collect()
    };
    let (one_bits, other_bits) = (bits(one), bits(other));
    let differing: Vec<usize> = (0..one_bits.len()).filter(|&at| one_bits[at] != other_bits[at]).collect();
    assert!(differing.is_empty() && one_bits.len() == other_bits.len(), "spheres {differing:?} differ");
    let counts = |run: &Run| (run.report.contacts, run.report.max_overlap.to_bits(), run.report.total_collisions);
    assert_eq!(counts(one), counts(other));
}

fn two_runs_give_the_same_bits(backend: Backend) {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let options = || Options::new().backend(backend).integrator(integrator);
        let steps = on(backend, 150, 25);
        same_bits(&run(options(), steps, 100), &run(options(), steps, 100));
    }
}

/// One run of many steps is the same as many runs of one: batches make no difference.
fn steps_one_by_one_give_the_same_bits(backend: Backend) {
    let (steps, balls) = (on(backend, 100, 40), 60);
    let whole = run(Options::new().backend(backend), steps, balls);
    let mut simulation = simulation(mixed(balls), backend);
    for _ in 0..steps {
        simulation.step(0.01).expect("a step");
    }
    let parts = Run { spheres: simulation.spheres().expect("spheres are read back"), report: simulation.report() };
    same_bits(&whole, &parts);
}

/// Lists that overflow never lose a contact: the step is void, they grow, it is run again.
fn a_start_without_room_gives_the_same_bits(backend: Backend) {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let options = |capacity| Options::new().backend(backend).integrator(integrator).pair_capacity(capacity);
        let (steps, balls) = (on(backend, 150, 30), on(backend, 200, 100));
        let tight = run(options(1), steps, balls);
        let roomy = run(options(1 << 18), steps, balls);
        assert!(
            tight.report.replays > roomy.report.replays,
            "capacity 1 must overflow: {} replays against {}",
            tight.report.replays,
            roomy.report.replays
        );
        same_bits(&tight, &roomy);
    }
}

/// A sphere that leaves its AABB voids the step, which is run again with wider ones: nothing is lost either. A force of
/// 1024 on a resting ball moves it by 1024 t^2 / 2, far out of the margin of its AABB, and into another ball that it
/// would not have met from its old lists: 0.125 in 1/64 s.
fn a_jerk_out_of_the_aabb_loses_nothing(backend: Backend) {
    let mut scene = weightless();
    scene.settings.friction = 0.0;
    let [jerked, other] =
        spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).force([1024.0, 0.0, 0.0]), Sphere::new([1.0625, 0.0, 0.0], 0.5)]);
    scene.settings.collisions = false;
    let mut simulation = simulation(scene, backend);
    let report = simulation.step(DT).expect("a step");
    assert!(report.replays > 0, "the ball must leave its AABB");
    let (jerked, other) = (simulation.sphere(jerked).expect("a ball"), simulation.sphere(other).expect("a ball"));
    assert!(other.velocity.x > 0.1, "the other must have been met in the later stages: {}", other.velocity);
    // Momentum is F t whatever the contact did.
    close(jerked.velocity.x + other.velocity.x, 16.0, 1e-4, "momentum");
}

/// Brute force keeps spheres in order of addition, the grid in spatial order: results know nothing of either. The balls are
/// added in an order that is far from a spatial one, with a hole in it that an edit left.
fn the_broad_phase_and_the_order_of_memory_make_no_difference(backend: Backend) {
    let shuffled = |method: BroadPhase| {
        let options = Options::new().backend(backend).broad_phase(method);
        let mut scene = mixed(0);
        let balls: Vec<SphereId> = (0..200)
            .map(|k| {
                let k = k * 77 % 200;
                let place = Vec3::new((k % 5) as f32 * 0.5 - 1.0, (k / 25) as f32 * 0.5 + 0.3, (k / 5 % 5) as f32 * 0.5 - 1.0);
                scene.add_sphere(Sphere::new(place, 0.22).mass(1.0 + (k % 3) as f32)).expect("a valid sphere")
            })
            .collect();
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        simulation.run(on(backend, 40, 10), 0.01).expect("steps");
        simulation.remove_sphere(balls[17]).expect("a ball to remove");
        simulation.set_velocity(balls[3], [1.0, 2.0, 0.0]).expect("a ball to throw");
        simulation.set_force(balls[5], [0.0, 30.0, 0.0]).expect("a ball to lift");
        let report = simulation.run(on(backend, 110, 20), 0.01).expect("steps");
        Run { spheres: simulation.spheres().expect("spheres are read back"), report }
    };
    same_bits(&shuffled(BroadPhase::BruteForce), &shuffled(BroadPhase::Grid));
}

/// After 2,000 steps spheres are put into spatial order again, which is not seen either.
#[test]
fn sorting_memory_again_makes_no_difference() {
    let options = |method| Options::new().backend(Backend::Cpu).broad_phase(method);
    let [brute, grid] = [BroadPhase::BruteForce, BroadPhase::Grid].map(|method| run(options(method), 2_100, 60));
    same_bits(&brute, &grid);
}

/// CPU, one thread and four.
#[test]
fn threads_make_no_difference() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| run(Options::new().backend(Backend::Cpu), 150, 300))
    };
    let one = with_threads(1);
    same_bits(&one, &with_threads(4));
    same_bits(&one, &with_threads(7));
}

both!(
    two_runs_give_the_same_bits,
    steps_one_by_one_give_the_same_bits,
    a_start_without_room_gives_the_same_bits,
    a_jerk_out_of_the_aabb_loses_nothing,
    the_broad_phase_and_the_order_of_memory_make_no_difference,
);
