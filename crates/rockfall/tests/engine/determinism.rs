//! The same input gives bitwise identical results, whatever the number of threads and the initial capacity of the
//! lists.

use rockfall::glam::Vec3;
use rockfall::{Backend, BroadPhase, Integrator, Options, Rod, Scene, Simulation, Sphere, SphereId};

use crate::common::mixed::{Run, assert_bitwise_identical, mixed};
use crate::common::*;

/// Runs steps of 10 ms and asserts that there were enough collisions and contacts.
fn run(options: Options, steps: u64, balls: usize) -> Run {
    let mut simulation = Simulation::with_options(mixed(balls), options).expect("the simulation opens");
    let report = simulation.run(steps, 0.01).expect("steps");
    assert!(report.total_collisions > 10 && report.contacts > 0, "{report:?}");
    let spheres = simulation.spheres().expect("spheres are read back");
    Run { spheres, report }
}

fn two_runs_are_bitwise_identical(backend: Backend) {
    for integrator in Integrator::ALL {
        let options = || Options::new().backend(backend).integrator(integrator);
        let steps = on(backend, 150, 25);
        assert_bitwise_identical(&run(options(), steps, 100), &run(options(), steps, 100));
    }
}

/// One run of many steps equals many runs of one step: batches make no difference.
fn single_steps_and_a_batch_are_bitwise_identical(backend: Backend) {
    let (steps, balls) = (on(backend, 100, 40), 60);
    let whole = run(Options::new().backend(backend), steps, balls);
    let mut simulation = simulation(mixed(balls), backend);
    for _ in 0..steps {
        simulation.step(0.01).expect("a step");
    }
    let parts = Run { spheres: simulation.spheres().expect("spheres are read back"), report: simulation.report() };
    assert_bitwise_identical(&whole, &parts);
}

/// Spheres without rods that fall on each other.
fn crowd() -> Scene {
    let mut scene = mixed(80);
    let rods: Vec<_> = scene.rod_ids().collect();
    rods.into_iter().for_each(|rod| scene.remove_rod(rod).expect("a rod of the scene"));
    scene
}

/// A resumed simulation starts without sweeps over collisions that share bodies, until it detects that they are needed.
/// Brute force and the grid list such collisions in different orders. Neither changes the result.
fn sweeps_that_restart_after_a_resume_make_no_difference(backend: Backend) {
    let options = |method| Options::new().backend(backend).broad_phase(method);
    let mut whole = Simulation::with_options(crowd(), options(BroadPhase::BruteForce)).expect("the simulation opens");
    whole.run(28, 0.01).expect("steps");
    let mut part = Simulation::with_options(crowd(), options(BroadPhase::Grid)).expect("the simulation opens");
    for _ in 0..4 {
        part.run(7, 0.01).expect("steps");
        let kept = part.checkpoint().expect("a checkpoint");
        part = Simulation::resume(kept).expect("the simulation resumes");
    }
    let [whole, part] = [&mut whole, &mut part].map(Run::of);
    assert!(whole.report.total_collisions > 50, "{:?}", whole.report);
    assert_bitwise_identical(&whole, &part);
}

/// Lists that overflow never lose a contact: the step is rejected, the lists grow, and the step is repeated.
fn the_initial_capacity_of_lists_makes_no_difference(backend: Backend) {
    for integrator in Integrator::ALL {
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
        assert_bitwise_identical(&tight, &roomy);
    }
}

/// A sphere that leaves its AABB makes the step be rejected and repeated with wider AABBs, so no contact is lost. A
/// force of 1024 moves a ball at rest by 1024 t^2 / 2 = 0.125 in 1/64 s. That is far outside its AABB and into another
/// ball that its old list lacks.
fn a_body_that_leaves_its_aabb_loses_no_contact(backend: Backend) {
    let mut scene = weightless();
    scene.settings.friction = 0.0;
    let [jerked, other] =
        spheres(&mut scene, [Sphere::new([0.0; 3], 0.5).force([1024.0, 0.0, 0.0]), Sphere::new([1.0625, 0.0, 0.0], 0.5)]);
    scene.settings.collisions = false;
    let mut simulation = simulation(scene, backend);
    let report = simulation.step(DT).expect("a step");
    assert!(report.replays > 0, "the ball must leave its AABB");
    let (jerked, other) = (simulation.sphere(jerked).expect("a ball"), simulation.sphere(other).expect("a ball"));
    assert!(other.velocity.x > 0.1, "the later stages must find the contact with the other ball: {}", other.velocity);
    // The total momentum is F t, whatever the contact does.
    close(jerked.velocity.x + other.velocity.x, 16.0, 1e-4, "momentum");
}

/// Brute force stores spheres in insertion order, the grid in spatial order. Results must not depend on either. The
/// insertion order of the balls is far from a spatial one, and an edit leaves a gap in it.
fn the_broad_phase_and_the_memory_order_make_no_difference(backend: Backend) {
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
    let brute = shuffled(BroadPhase::BruteForce);
    assert_bitwise_identical(&brute, &shuffled(BroadPhase::Grid));
    assert_bitwise_identical(&brute, &shuffled(BroadPhase::SortAndSkip));
}

/// Slot in memory of every sphere. Asserts that no two spheres share one.
fn slots(simulation: &Simulation, spheres: usize) -> Vec<usize> {
    let slots: Vec<usize> = (0..spheres).map(|sphere| simulation.slot(sphere)).collect();
    let mut places = slots.clone();
    places.sort_unstable();
    assert!(places.into_iter().eq(0..spheres), "{slots:?}");
    slots
}

/// Sorting the memory during a run with edits does not change the results.
fn sorting_memory_makes_no_difference(backend: Backend) {
    let (rounds, steps) = on(backend, (8, 20), (3, 8));
    let run = |method: BroadPhase| {
        let options = Options::new().backend(backend).broad_phase(method);
        let mut simulation = Simulation::with_options(mixed(60), options).expect("the simulation opens");
        let ids: Vec<SphereId> = simulation.scene().sphere_ids().collect();
        let (count, mut moves) = (ids.len(), 0);
        for round in 0..rounds {
            simulation.run(steps, 0.01).expect("steps");
            // Edits before the sort, because an edit rebuilds all references to spheres and would hide references that
            // the sort did not update.
            simulation.set_velocity(ids[round * 7], [1.0, 2.0, 0.0]).expect("a ball to throw");
            simulation.set_force(ids[round * 5], [0.0, 30.0, 0.0]).expect("a ball to lift");
            let before = slots(&simulation, count);
            simulation.sort_memory().expect("a sort");
            moves += usize::from(slots(&simulation, count) != before);
        }
        simulation.run(steps, 0.01).expect("steps");
        assert_eq!(moves > 0, method == BroadPhase::Grid, "{moves} sorts changed the order");
        Run::of(&mut simulation)
    };
    assert_bitwise_identical(&run(BroadPhase::BruteForce), &run(BroadPhase::Grid));
}

/// A few large spheres and, optionally, a long rod in a pile of small spheres. On a device, workgroups build and
/// process their long lists. The lists start without capacity. With brute force, large spheres are not last in memory,
/// so one thread processes each list.
fn long_lists_processed_by_workgroups_make_no_difference(backend: Backend) {
    let run = |method: BroadPhase, with_rod: bool| {
        let mut scene = with(|settings| settings.gravity = 10.0);
        floor_box(&mut scene);
        for k in 0..180 {
            let place = Vec3::new((k % 6) as f32 * 0.21 - 0.5, (k / 36) as f32 * 0.21 + 1.3, (k / 6 % 6) as f32 * 0.21 - 0.5);
            let ball = Sphere::new(place, 0.1).velocity([0.0, -2.0, 0.0]);
            scene.add_sphere(ball).expect("a valid sphere");
            if k % 60 == 10 {
                let place = [0.55 * (k / 60) as f32 - 0.6, 0.6, 0.5 * (k / 60 % 2) as f32];
                scene.add_sphere(Sphere::new(place, 0.6).mass(5.0)).expect("a valid sphere");
            }
        }
        let ends = [-0.8, 0.8].map(|x| scene.add_sphere(Sphere::new([x, 1.2, 0.7], 0.1)).expect("a valid sphere"));
        if with_rod {
            scene.add_rod(Rod::new(ends[0], ends[1], 0.05).length(1.6)).expect("a valid rod");
        }
        let options = Options::new().backend(backend).broad_phase(method).pair_capacity(1);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        simulation.run(on(backend, 60, 10), 0.01).expect("steps");
        simulation.sort_memory().expect("a sort");
        let report = simulation.run(on(backend, 60, 10), 0.01).expect("steps");
        assert!(report.replays > 0 && report.total_collisions > 10 && report.contacts > 0, "{report:?}");
        Run::of(&mut simulation)
    };
    for with_rod in [true, false] {
        assert_bitwise_identical(&run(BroadPhase::BruteForce, with_rod), &run(BroadPhase::Grid, with_rod));
    }
}

/// On a device, Verlet lists are rebuilt in only a few steps of a batch. A ball then hits the crowd and pushes spheres
/// out of their AABBs in steps that cannot rebuild lists. Steps that are submitted one by one may rebuild lists in
/// every step.
#[test]
#[cfg(feature = "gpu")]
fn lists_that_are_rebuilt_rarely_lose_no_contact() {
    let scene = || {
        let mut scene = weightless();
        let crowd = (0..60).map(|k| Vec3::new((k % 4) as f32, (k / 16) as f32, (k / 4 % 4) as f32));
        for place in crowd {
            scene.add_sphere(Sphere::new(place, 0.499)).expect("a valid sphere");
        }
        // Arrives after 3 s.
        scene.add_sphere(Sphere::new([-25.0, 1.1, 0.9], 0.5).mass(5.0).velocity([8.0, 0.0, 0.0])).expect("a valid sphere");
        let options = Options::new().backend(Backend::Gpu).broad_phase(BroadPhase::Grid);
        Simulation::with_options(scene, options).expect("the simulation opens")
    };
    let (mut whole, mut parts) = (scene(), scene());
    whole.run(256, 0.01).expect("steps before the ball arrives");
    let before = whole.profile(32, 0.01).expect("a profile");
    let builds =
        before.stages.iter().find(|stage| stage.name == "find_neighbours").expect("the stage that builds the lists").runs;
    assert!(builds <= 32 / 4, "lists may be rebuilt in {builds} of 32 steps");
    whole.run(72, 0.01).expect("steps");
    for _ in 0..360 {
        parts.step(0.01).expect("a step");
    }
    let [whole, parts] = [&mut whole, &mut parts].map(Run::of);
    assert!(whole.report.replays > parts.report.replays, "no sphere left its AABB: {:?}", whole.report);
    assert_bitwise_identical(&whole, &parts);
}

/// After all bodies were moved by hand, memory is in a random order. This must be detected.
fn memory_is_sorted_only_when_it_is_unordered(backend: Backend) {
    // At rest, as close as possible without touching.
    let mut scene = weightless();
    let place = |k: usize| Vec3::new((k % 8) as f32, (k / 64) as f32, (k / 8 % 8) as f32);
    let balls: Vec<SphereId> =
        (0..512).map(|k| scene.add_sphere(Sphere::new(place(k), 0.499)).expect("a valid sphere")).collect();
    let options = Options::new().backend(backend).broad_phase(BroadPhase::Grid);
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    // Long enough for four checks of the order, which is good.
    simulation.run(on(backend, 1100, 300), 0.001).expect("steps");
    let version = simulation.memory_version();
    assert_eq!(version, 1, "memory was sorted although it was in order");
    for (k, ball) in balls.iter().enumerate() {
        simulation.set_position(*ball, place(k * 197 % 512)).expect("a ball to move");
    }
    simulation.run(300, 0.001).expect("steps");
    assert!(simulation.memory_version() > version, "the disorder was not detected");
}

/// The CPU backend with one, four and seven threads.
#[test]
fn the_number_of_threads_makes_no_difference() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| run(Options::new().backend(Backend::Cpu), 150, 300))
    };
    let one = with_threads(1);
    assert_bitwise_identical(&one, &with_threads(4));
    assert_bitwise_identical(&one, &with_threads(7));
}

both!(
    two_runs_are_bitwise_identical,
    single_steps_and_a_batch_are_bitwise_identical,
    sweeps_that_restart_after_a_resume_make_no_difference,
    the_initial_capacity_of_lists_makes_no_difference,
    a_body_that_leaves_its_aabb_loses_no_contact,
    the_broad_phase_and_the_memory_order_make_no_difference,
    sorting_memory_makes_no_difference,
    long_lists_processed_by_workgroups_make_no_difference,
    memory_is_sorted_only_when_it_is_unordered,
);
