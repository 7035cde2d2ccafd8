//! Periodic boundaries (docs/physics section 2.14).

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, Capsule, Checkpoint, ContactLaw, Cuboid, Integrator, Material, Motion, MotionTerm, Options, Pair,
    Polygon, Scene, Simulation, Sphere, SphereState, Spring,
};

use crate::common::{bits_of, close, near, with};

fn open(scene: Scene, backend: Backend, integrator: Integrator, broad_phase: BroadPhase) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator).broad_phase(broad_phase);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// A scene of smooth bodies without gravity. All contacts that approach collide, with restitution 1.
fn smooth() -> Scene {
    with(|settings| {
        (settings.gravity, settings.activation_threshold, settings.restitution) = (0.0, 0.0, 1.0);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    })
}

fn set_periods(scene: &mut Scene, bounds: [Option<[f32; 2]>; 3]) {
    for (axis, bounds) in bounds.into_iter().enumerate() {
        scene.set_periodic(axis, bounds).expect("valid bounds");
    }
}

/// Bodies of all kinds in a box of 4 units, with a floor that spans it, an obstacle, and a paddle that turns.
fn crowd(law: ContactLaw, number: usize) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        settings.gravity = 2.0;
    });
    let stuff = scene.add_material(Material::new("stuff").density(800.0).young(2e5).poisson(0.3)).expect("a material");
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.6).friction(0.4)).expect("a valid pair");
    let mut place = |least: f32, most: f32| {
        // Multiples of 2^-12, so that whole periods can be added without rounding.
        let mut coordinate = |least: f32, most: f32| (random.random_range(least..most) * 4096.0).round() / 4096.0;
        Vec3::new(coordinate(0.0, 4.0), coordinate(least, most), coordinate(0.0, 4.0))
    };
    let mut last = None;
    for index in 0..number {
        let at = place(0.3, 3.0);
        let velocity = 0.5 * (place(0.3, 3.0) - Vec3::new(2.0, 1.5, 2.0));
        let radius = if index % 3 == 0 { 0.2 } else { 0.14 };
        if law == ContactLaw::Thesis && index % 7 == 0 {
            let capsule = Capsule::new(at, at + Vec3::new(0.25, 0.125, 0.25), 0.1).velocity(velocity).material(stuff);
            scene.add_capsule(capsule).expect("a valid capsule");
            continue;
        }
        let ball = scene.add_sphere(Sphere::new(at, radius).velocity(velocity).material(stuff)).expect("a valid sphere");
        if index % 11 == 5 {
            let other = at + Vec3::new(0.5, 0.0, 0.25);
            let other = scene.add_sphere(Sphere::new(other, radius).material(stuff)).expect("a valid sphere");
            scene.add_spring(Spring::new(ball, other, 50.0, 0.5)).expect("a valid spring");
        }
        last = Some(ball);
    }
    assert!(last.is_some());
    for [x, z] in [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]] {
        scene.add_box(Cuboid::between([x, -0.5, z], [x + 2.0, 0.0, z + 2.0]).material(stuff)).expect("a valid box");
    }
    scene.add_box(Cuboid::between([3.5, 0.0, 3.25], [4.25, 0.5, 3.75]).material(stuff)).expect("a valid box");
    let term = MotionTerm::turn(3.0, [0.0, 1.0, 0.0], [2.0, 0.0, 0.25]);
    let paddle = scene.add_motion(Motion::new("paddle", term)).expect("a valid motion");
    let face = Polygon::new([1.25, 0.0, 0.25], [0.0, 1.0, 0.0], [1.5, 0.0, 0.0]);
    let back = Polygon::new([1.25, 0.0, 0.25], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for polygon in [face, back] {
        scene.add_polygon(polygon.motion(paddle).material(stuff)).expect("a valid polygon");
    }
    scene
}

fn periods_from(x: f32, z: f32) -> [Option<[f32; 2]>; 3] {
    [Some([x, x + 4.0]), None, Some([z, z + 4.0])]
}

fn integrator_of(law: ContactLaw) -> (Integrator, f32) {
    if law == ContactLaw::Thesis { (Integrator::Rk4, 0.005) } else { (Integrator::VelocityVerlet, 5e-4) }
}

/// The faces of the box may be anywhere, and any broad phase finds the pairs: the states have the same bits.
fn results_do_not_depend_on_where_the_faces_are(backend: Backend) {
    for law in [ContactLaw::Thesis, ContactLaw::HertzMindlin] {
        let (integrator, dt) = integrator_of(law);
        let run = |bounds, broad_phase| {
            let mut scene = crowd(law, 90);
            set_periods(&mut scene, bounds);
            let mut simulation = open(scene, backend, integrator, broad_phase);
            let mut touching = 0;
            for _ in 0..10 {
                touching += simulation.run(15, dt).expect("steps").contacts;
            }
            (bits_of(&mut simulation), touching)
        };
        let plain = run(periods_from(0.0, 0.0), BroadPhase::Grid);
        assert!(plain.1 > 25, "{} contacts, {law}", plain.1);
        assert!(run(periods_from(0.0, 0.0), BroadPhase::BruteForce) == plain, "brute force, {law}");
        assert!(run(periods_from(-1.37, 2.71), BroadPhase::Grid) == plain, "other faces, {law}");
        assert!(run([None; 3], BroadPhase::Grid) != plain, "without periods, {law}");
    }
}

/// A body that is written some periods away moves as it would in the box.
fn bodies_may_be_written_in_any_image(backend: Backend) {
    for law in [ContactLaw::Thesis, ContactLaw::HertzMindlin] {
        let (integrator, dt) = integrator_of(law);
        let run = |moved: bool| {
            let mut scene = crowd(law, 60);
            set_periods(&mut scene, periods_from(0.0, 0.0));
            let ids: Vec<_> = scene.sphere_ids().collect();
            let rods = scene.rods().iter().flat_map(|rod| [rod.end1, rod.end2]);
            let joined: Vec<_> = rods.chain(scene.springs().iter().flat_map(|spring| [spring.a, spring.b])).collect();
            // Ends of rods and springs stay together.
            let way = |index: usize| match moved && !joined.contains(&ids[index]) {
                true => Vec3::new(4.0 * (index % 3) as f32, 0.0, -4.0 * (index % 2) as f32),
                false => Vec3::ZERO,
            };
            let ways: Vec<Vec3> = (0..ids.len()).map(way).collect();
            let mut simulation = open(scene, backend, integrator, BroadPhase::Auto);
            for (id, way) in ids.iter().zip(&ways) {
                let place = simulation.scene().sphere(*id).expect("a sphere").position;
                simulation.set_position(*id, place + *way).expect("a valid position");
            }
            simulation.run(20, dt).expect("steps");
            let states = simulation.spheres().expect("spheres are read back").to_vec();
            (states, ways)
        };
        let ((plain, _), (moved, ways)) = (run(false), run(true));
        for ((one, other), way) in plain.iter().zip(&moved).zip(ways) {
            near(other.velocity, one.velocity.as_dvec3(), 1e-4, &format!("velocity, {law}"));
            near(other.position - way, one.position.as_dvec3(), 1e-5, &format!("position, {law}"));
        }
    }
}

/// Two balls that meet across a face, or across an edge of the box, do what they do inside of it.
fn a_pair_across_a_face_moves_as_inside(backend: Backend) {
    let cases = [(Integrator::Rk4, true), (Integrator::SymplecticEuler, false), (Integrator::VelocityVerlet, false)];
    for (integrator, continuous) in cases {
        let speed = if continuous { 30.0 } else { 1.0 };
        let run = |shift: Vec3| {
            let mut scene = smooth();
            scene.settings.continuous_collisions = continuous;
            set_periods(&mut scene, [Some([0.0, 2.0]), Some([0.0, 2.0]), None]);
            let one = Sphere::new(Vec3::new(0.75, 0.75, 0.0) + shift, 0.125).velocity([speed, 0.875 * speed, 0.0]);
            let mut other = Sphere::new(Vec3::new(1.25, 1.25, 0.0) + shift, 0.25).velocity([-speed, -speed, 0.0]).mass(2.0);
            // Across the corner of the box, the other ball is brought back.
            other.position -= 2.0 * shift;
            scene.add_sphere(one).expect("a valid sphere");
            scene.add_sphere(other).expect("a valid sphere");
            let mut simulation = open(scene, backend, integrator, BroadPhase::Grid);
            let report = simulation.run(if continuous { 4 } else { 40 }, 0.01).expect("steps");
            let velocities = simulation.spheres().expect("spheres").iter().map(|ball| ball.velocity).collect::<Vec<_>>();
            (velocities, report.total_collisions)
        };
        let (inside, hits) = run(Vec3::ZERO);
        assert_eq!(hits, 1, "{integrator}, continuous {continuous}");
        let (across, _) = run(Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(inside, across, "{integrator}, continuous {continuous}");
        let momentum: f64 = inside.iter().zip([1.0, 2.0]).map(|(velocity, mass)| mass * f64::from(velocity.x)).sum();
        close(momentum, -f64::from(speed), 1e-5 * f64::from(speed), "momentum");
    }
}

/// A gas in a periodic box of three cells keeps its momentum and, with elastic collisions, its energy.
fn a_gas_keeps_momentum_and_energy(backend: Backend) {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut scene = smooth();
    set_periods(&mut scene, [Some([0.0, 1.0]); 3]);
    for index in 0..64 {
        let place = Vec3::new((index % 4) as f32, (index / 4 % 4) as f32, (index / 16) as f32) * 0.25 + 0.1;
        let velocity = Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        scene.add_sphere(Sphere::new(place, 0.08).velocity(velocity)).expect("a valid sphere");
    }
    let sums = |states: &[SphereState]| {
        let velocities = || states.iter().map(|state| state.velocity.as_dvec3());
        (velocities().sum::<DVec3>(), velocities().map(|velocity| 0.5 * velocity.length_squared()).sum::<f64>())
    };
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut simulation = open(scene.clone(), backend, integrator, BroadPhase::Auto);
        let (momentum, energy) = sums(&simulation.spheres().expect("spheres"));
        let report = simulation.run(1_000, 0.002).expect("steps");
        assert!(report.total_collisions > 400, "{integrator}: {} collisions", report.total_collisions);
        let states = simulation.spheres().expect("spheres");
        let (after, energy_after) = sums(&states);
        assert!((after - momentum).length() < 1e-4, "{integrator}: {momentum} {after}");
        close(energy_after, energy, 0.01 * energy, &format!("energy, {integrator}"));
        // Nobody stayed in the box, and nobody is nearer to an image than contacts allow.
        assert!(states.iter().any(|state| state.position.abs().max_element() > 1.2));
    }
}

/// A ball rolls for twenty periods over a floor of tiles that spans the box.
fn a_ball_rolls_over_a_floor_that_spans_the_box(backend: Backend) {
    let mut scene = smooth();
    scene.settings.gravity = 9.81;
    set_periods(&mut scene, [Some([-1.0, 1.0]), None, None]);
    for x in [-1.0, -0.5, 0.0, 0.5] {
        scene.add_box(Cuboid::between([x, -0.5, -1.0], [x + 0.5, 0.0, 1.0])).expect("a valid box");
    }
    scene.add_sphere(Sphere::new([0.9, 0.1, 0.0], 0.1).velocity([3.0, 0.0, 0.0])).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::Rk4, BroadPhase::Auto);
    simulation.run(2_800, 0.005).expect("steps");
    let ball = simulation.spheres().expect("spheres")[0];
    near(ball.velocity.with_y(0.0), [3.0, 0.0, 0.0], 1e-4, "velocity");
    assert!(ball.velocity.y.abs() < 1e-2 && ball.position.y > 0.08, "{ball:?}");
    close(ball.position.x, 42.9, 1e-2, "way");
}

/// A ball flies to and fro between a wall and its next image.
fn a_ball_hits_both_sides_of_a_wall(backend: Backend) {
    let mut scene = smooth();
    set_periods(&mut scene, [Some([-1.0, 1.0]), None, None]);
    scene.add_box(Cuboid::between([-0.95, -1.0, 4.0], [-0.75, 1.0, 6.0])).expect("a valid box");
    scene.add_sphere(Sphere::new([0.5, 0.0, 5.0], 0.1).velocity([1.0, 0.0, 0.0])).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::Rk4, BroadPhase::Auto);
    simulation.run(1_400, 0.01).expect("steps");
    let ball = simulation.spheres().expect("spheres")[0];
    // The first hit is at x = 0.95, and between the faces of the wall there are 2 - 0.2 - 2 r = 1.6 units.
    let turns = (14.0_f64 - 0.45) / 1.6;
    assert_eq!(turns.floor() as u32 % 2, 0);
    close(ball.position.x, 0.95 - turns.fract() * 1.6, 1e-3, "place");
    near(ball.velocity, [-1.0, 0.0, 0.0], 1e-5, "velocity");
}

/// A plate that spans the box slides along it for ever, and takes a sphere along.
fn a_plate_slides_along_the_box(backend: Backend) {
    let mut scene = with(|settings| {
        settings.set("contact_law", "hertz-mindlin").expect("a law");
        settings.gravity = 9.81;
    });
    let stuff = scene.add_material(Material::new("stuff").density(2_500.0).young(1e6).poisson(0.3)).expect("a material");
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.3).friction(0.3)).expect("a valid pair");
    set_periods(&mut scene, [Some([0.0, 1.0]), None, None]);
    let motion = scene.add_motion(Motion::new("slide", MotionTerm::translation([2.0, 0.0, 0.0]))).expect("a valid motion");
    scene.add_box(Cuboid::between([0.0, -0.2, 0.0], [1.0, 0.0, 1.0]).motion(motion).material(stuff)).expect("a valid box");
    scene.add_sphere(Sphere::new([0.95, 0.1, 0.5], 0.1).material(stuff)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet, BroadPhase::Auto);
    simulation.run(10_000, 2e-4).expect("steps");
    let ball = simulation.spheres().expect("spheres")[0];
    // It slips until it rolls at 2/7 of the speed of the plate (walls that move, belt).
    close(ball.velocity.x, 4.0 / 7.0, 0.012, "speed");
    assert!(ball.position.y > 0.09, "{ball:?}");
    assert!(ball.position.x > 1.9, "{ball:?}");
}

/// A stopped and resumed run has the same bits.
fn checkpoints_have_periods(backend: Backend) {
    let (integrator, dt) = integrator_of(ContactLaw::HertzMindlin);
    let mut scene = crowd(ContactLaw::HertzMindlin, 40);
    set_periods(&mut scene, periods_from(0.5, 0.5));
    let mut simulation = open(scene, backend, integrator, BroadPhase::Auto);
    simulation.run(60, dt).expect("steps");
    let checkpoint = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let mut resumed =
        Simulation::resume(Checkpoint::from_bytes(&checkpoint, "memory").expect("it reads back")).expect("it resumes");
    simulation.run(60, dt).expect("steps");
    resumed.run(60, dt).expect("steps");
    assert_eq!(resumed.scene().periodic(), periods_from(0.5, 0.5));
    assert!(bits_of(&mut simulation) == bits_of(&mut resumed));
}

/// What cannot be computed is refused.
fn bodies_that_are_too_wide_are_refused(backend: Backend) {
    let refused = |scene: Scene, broad_phase: BroadPhase| {
        let options = Options::new().backend(backend).broad_phase(broad_phase);
        Simulation::with_options(scene, options).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let periodic = || {
        let mut scene = smooth();
        set_periods(&mut scene, [None, Some([0.0, 1.0]), None]);
        scene
    };
    let mut wide = periodic();
    wide.add_sphere(Sphere::new([0.0; 3], 0.26)).expect("a valid sphere");
    assert!(refused(wide, BroadPhase::Auto).contains("sphere 0 is 0.52 units long along y"));
    let mut long = periodic();
    long.add_capsule(Capsule::new([0.0, 0.0, 0.0], [0.0, 0.4, 0.0], 0.1)).expect("a valid capsule");
    assert!(refused(long, BroadPhase::Auto).contains("along y"));
    let mut sorted = periodic();
    sorted.add_sphere(Sphere::new([0.0; 3], 0.1)).expect("a valid sphere");
    assert!(refused(sorted.clone(), BroadPhase::SortAndSkip).contains("sort-and-skip"));
    sorted.settings.precision = rockfall::Precision::Single;
    assert!(refused(sorted.clone(), BroadPhase::Auto).contains("precision"));
    assert!(sorted.set_periodic(3, None).is_err() && sorted.set_periodic(0, Some([1.0, 1.0])).is_err());
}

both! {
    results_do_not_depend_on_where_the_faces_are,
    bodies_may_be_written_in_any_image,
    a_pair_across_a_face_moves_as_inside,
    a_gas_keeps_momentum_and_energy,
    a_ball_rolls_over_a_floor_that_spans_the_box,
    a_ball_hits_both_sides_of_a_wall,
    a_plate_slides_along_the_box,
    checkpoints_have_periods,
    bodies_that_are_too_wide_are_refused,
}
