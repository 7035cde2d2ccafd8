//! Gauges, and the work of walls and muscles (docs/physics section 2.12), against closed forms and balances.

use rockfall::glam::DVec3;
use rockfall::{
    Backend, Checkpoint, ContactLaw, Cuboid, Gauge, GaugeReading, Integrator, Material, MaterialId, Meter, Motion, MotionTerm,
    Muscle, Pair, Polygon, Scene, Simulation, Sphere, Spring, Tag, WallLoad,
};

use crate::common::{close, near, on, open, spheres, with};

/// A scene with a law with history, and its only material.
fn grains(law: ContactLaw, e: f32, friction: f32, gravity: f32) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (law, false, gravity);
    });
    let hard = scene.add_material(Material::new("hard").density(1_000.0).young(1e6).poisson(0.25)).expect("a valid material");
    let pair = Pair::default().restitution(e).friction(friction).stiffness(1e4);
    scene.set_pair(hard, hard, pair).expect("a valid pair");
    (scene, hard)
}

fn loads(simulation: &mut Simulation) -> Vec<WallLoad> {
    let wall = |reading| match reading {
        GaugeReading::Wall(load) => load,
        other => panic!("{other:?}"),
    };
    simulation.gauges().expect("gauges").into_iter().map(wall).collect()
}

fn flows(simulation: &mut Simulation) -> Vec<(f64, i64)> {
    let plane = |reading| match reading {
        GaugeReading::Plane { mass, count } => (mass, count),
        other => panic!("{other:?}"),
    };
    simulation.gauges().expect("gauges").into_iter().map(plane).collect()
}

/// A settled pile in a bin weighs what its grains weigh: the forces on the floor and on the sides add up to the weight. So do their
/// means over steps.
fn a_bin_bears_the_weight_of_a_pile(backend: Backend) {
    let (mut scene, hard) = grains(ContactLaw::Linear, 0.2, 0.4, 10.0);
    for (name, min, max) in [
        ("floor", [-0.3, -0.1, -0.3], [0.3, 0.0, 0.3]),
        ("sides", [-0.3, 0.0, -0.3], [-0.21, 1.0, 0.3]),
        ("sides", [0.21, 0.0, -0.3], [0.3, 1.0, 0.3]),
        ("sides", [-0.21, 0.0, -0.3], [0.21, 1.0, -0.21]),
        ("sides", [-0.21, 0.0, 0.21], [0.21, 1.0, 0.3]),
    ] {
        let wall = scene.add_box(Cuboid::between(min, max).material(hard)).expect("a valid box");
        scene.set_tag(wall, Tag::new().name(name)).expect("a valid tag");
    }
    let mut mass = 0.0;
    for k in 0..on(backend, 16_u8, 8) {
        let [x, z, y] = [k % 2, (k / 2) % 2, k / 4].map(f32::from);
        let ball = Sphere::new([0.2 * x - 0.1 + 0.004 * (y % 3.0), 0.1 + 0.2 * y, 0.2 * z - 0.1], 0.1).density(100.0);
        mass += f64::from(ball.mass);
        scene.add_sphere(ball.material(hard)).expect("a valid sphere");
    }
    scene.add_gauge(Gauge::wall("on-the-floor", "floor")).expect("a valid gauge");
    scene.add_gauge(Gauge::wall("on-the-sides", "sides")).expect("a valid gauge");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(on(backend, 12_000, 3_000), 5e-4).expect("steps");
    let mut meter = Meter::new(simulation.scene(), true, false);
    simulation.run_metered(40, 5e-4, &mut meter).expect("steps");
    assert_eq!(meter.steps, 40);
    let (now, means) = (loads(&mut simulation), meter.take_means());
    assert_eq!(meter.steps, 0);
    let weight = -10.0 * mass;
    close(now[0].force.y + now[1].force.y, weight, -0.01 * weight, "weight");
    close(means[0][0].y + means[1][0].y, weight, -0.01 * weight, "mean weight");
    assert_eq!(now[0], simulation.wall_load("floor").expect("a wall"));
    assert!(now[0].contacts == 4 && now[1].contacts > 0, "{now:?}");
}

/// Balls that slip on a disk brake it with the torque of their friction, mu m g r each.
fn a_disk_feels_the_friction_of_balls(backend: Backend) {
    let (mut scene, hard) = grains(ContactLaw::Linear, 0.1, 0.25, 10.0);
    let turn = MotionTerm::turn(5.0, DVec3::Y, DVec3::ZERO);
    let motion = scene.add_motion(Motion::new("motor", turn)).expect("a valid motion");
    scene.add_box(Cuboid::between([-1.0, -0.1, -1.0], [1.0, 0.0, 1.0]).motion(motion).material(hard)).expect("a valid box");
    let mut torque = 0.0;
    for (x, z, mass) in [(0.5_f32, 0.0_f32, 0.2_f32), (0.0, -0.6, 0.3), (-0.4, 0.3, 0.4)] {
        let ball = Sphere::new([x, 0.05, z], 0.05).mass(mass).material(hard);
        scene.add_sphere(ball).expect("a valid sphere");
        torque += f64::from(mass) * f64::from(x.hypot(z)) * 0.25 * 10.0;
    }
    scene.add_gauge(Gauge::wall("motor", "motor")).expect("a valid gauge");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let dt = 2e-4;
    simulation.run(250, dt).expect("steps");
    // Over a whole number of oscillations of the overlap, or many.
    let mut meter = Meter::new(simulation.scene(), true, true);
    let steps = on(backend, 250, 100);
    simulation.run_metered(steps, dt, &mut meter).expect("steps");
    let work = meter.work;
    let mean = meter.take_means()[0];
    close(mean[1].y, -torque, 0.01 * torque, "torque");
    // The motor does the work of that torque.
    close(work, torque * 5.0 * steps as f64 * f64::from(dt), 0.01 * work, "work");
}

/// What passes a plane: along its normal minus against it, without spheres that edits move, add or remove. No step in between has to
/// be seen.
fn planes_count_what_passes(backend: Backend) {
    let mut scene = with(|settings| (settings.gravity, settings.restitution, settings.activation_threshold) = (10.0, 1.0, 0.0));
    scene.add_box(Cuboid::between([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0])).expect("a valid box");
    let ball = |x: f32, y: f32, mass: f32| Sphere::new([x, y, 0.0], 0.1).mass(mass);
    // One ball falls through the plane, another one too and comes back, one stays above and one below.
    spheres(&mut scene, [ball(0.0, 1.7, 2.0), ball(1.0, 1.05, 4.0), ball(2.0, 8.0, 8.0), ball(3.0, 0.3, 16.0)]);
    scene.add_sphere(ball(4.0, 1.5, 32.0).fixed()).expect("a valid sphere");
    scene.add_gauge(Gauge::plane("down", [0.0, 1.0, 0.0], [0.0, -3.0, 0.0])).expect("a valid gauge");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    assert_eq!(flows(&mut simulation), [(0.0, 0)]);
    let dt = 1.0 / 256.0;
    // After 0.2 s the second ball is below, after 0.4 s the first one too; at 0.8 s the second one is back.
    simulation.run(52, dt).expect("steps");
    assert_eq!(flows(&mut simulation), [(4.0, 1)]);
    simulation.run(52, dt).expect("steps");
    assert_eq!(flows(&mut simulation), [(6.0, 2)]);
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("intact")).expect("it resumes");
    assert_eq!(flows(&mut resumed), [(6.0, 2)]);
    // Edits do not count: one ball below goes and one above goes, one comes below, one jumps up and one jumps down.
    let first = resumed.scene().sphere_ids().next().expect("a sphere");
    resumed.remove_sphere(first).expect("a sphere");
    resumed.add_sphere(ball(-2.0, 0.5, 64.0)).expect("a valid sphere");
    let ids: Vec<_> = resumed.scene().sphere_ids().collect();
    resumed.set_position(ids[1], [2.0, 0.5, 0.0]).expect("a sphere");
    resumed.set_position(ids[2], [3.0, 6.0, 0.0]).expect("a sphere");
    assert_eq!(flows(&mut resumed), [(6.0, 2)]);
    resumed.remove_sphere(ids[0]).expect("a sphere");
    assert_eq!(flows(&mut resumed), [(6.0, 2)]);
    // The ball that jumped up falls again.
    resumed.add_gauge(Gauge::plane("up", [0.0, 1.0, 0.0], [0.0, 1.0, 0.0])).expect("a valid gauge");
    resumed.run(300, dt).expect("steps");
    let [down, up] = flows(&mut resumed)[..] else { panic!("two gauges") };
    assert_eq!((up.0 + down.0, up.1 + down.1), (6.0, 2));
    simulation.restore(&Checkpoint::from_bytes(&bytes, "memory").expect("intact")).expect("it goes back");
    let second = simulation.scene().sphere_ids().nth(1).expect("a sphere");
    simulation.remove_sphere(second).expect("a sphere");
    assert_eq!(flows(&mut simulation), [(6.0, 2)]);
}

/// In a periodic scene a plane has images. A sphere that goes round passes one of them on every round, either way; a tilted plane has none.
fn planes_count_each_round(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 0.0);
    scene.set_periodic(0, Some([-1.0, 1.0])).expect("a periodic axis");
    for (y, speed, mass) in [(0.0, 8.0, 2.0), (3.0, -4.0, 16.0)] {
        let ball = Sphere::new([-0.5, y, 0.0], 0.1).mass(mass).velocity([speed, 0.0, 0.0]);
        scene.add_sphere(ball).expect("a valid sphere");
    }
    for (name, normal) in [("right", [5.0, 0.0, 0.0]), ("left", [-1.0, 0.0, 0.0]), ("tilted", [1.0, 0.1, 0.0])] {
        scene.add_gauge(Gauge::plane(name, [0.25, 0.0, 0.0], normal)).expect("a valid gauge");
    }
    let mut simulation = open(scene, backend, Integrator::SymplecticEuler);
    // After 1 s the first ball is at 7.5 and has passed 0.25, 2.25, 4.25 and 6.25, and the second one is at -4.5 and has passed -1.75 and -3.75.
    simulation.run(64, 1.0 / 64.0).expect("steps");
    let found = flows(&mut simulation);
    assert_eq!(found[0], (4.0 * 2.0 - 2.0 * 16.0, 2), "{found:?}");
    assert_eq!(found[1], (-found[0].0, -found[0].1));
    assert_eq!(found[2], (2.0, 1), "{found:?}");
}

/// The energy that elastic grains gain is the work of the piston that compresses them, with every law and integrator.
fn a_piston_does_the_work_that_grains_gain(backend: Backend) {
    for (law, integrator) in [
        (ContactLaw::Thesis, Integrator::Rk4),
        (ContactLaw::Thesis, Integrator::SymplecticEuler),
        (ContactLaw::Linear, Integrator::VelocityVerlet),
        (ContactLaw::HertzMindlin, Integrator::VelocityVerlet),
    ] {
        let (mut scene, hard) = grains(law, 1.0, 0.0, 0.0);
        let settings = &mut scene.settings;
        (settings.collisions, settings.restitution) = (law == ContactLaw::Thesis, 1.0);
        (settings.friction, settings.contact_damping, settings.activation_threshold) = (0.0, 0.0, 0.0);
        let push = MotionTerm::oscillation([0.3, 0.0, 0.0], 1.0).during(0.0, 0.25);
        let motion = scene.add_motion(Motion::new("piston", push)).expect("a valid motion");
        let polygon = Polygon::new([-0.5, -0.5, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]).material(hard).motion(motion);
        scene.add_polygon(polygon).expect("a valid polygon");
        for (min, max) in [
            ([0.5, -0.5, -0.5], [0.6, 0.5, 0.5]),
            ([-0.6, -0.6, -0.6], [0.6, -0.5, 0.6]),
            ([-0.6, 0.5, -0.6], [0.6, 0.6, 0.6]),
            ([-0.6, -0.5, -0.6], [0.6, 0.5, -0.5]),
            ([-0.6, -0.5, 0.5], [0.6, 0.5, 0.6]),
        ] {
            scene.add_box(Cuboid::between(min, max).material(hard)).expect("a valid box");
        }
        for k in 0..8_u8 {
            let [x, y, z] = [k % 2, (k / 2) % 2, k / 4].map(|place| 0.36 * f32::from(place) - 0.18);
            let velocity = [3.0 - 6.0 * f32::from(k % 2), 0.7 * f32::from(k % 3), -0.6 * f32::from(k % 5)];
            let ball = Sphere::new([x, y + 0.01 * f32::from(k % 3), z], 0.1).mass(1.0).velocity(velocity);
            scene.add_sphere(ball.material(hard)).expect("a valid sphere");
        }
        let mut simulation = open(scene, backend, integrator);
        let dt = on(backend, 5e-5, 5e-4);
        simulation.set_time_step(dt).expect("a time step");
        let before = simulation.energy().expect("energies").total();
        let mut meter = Meter::new(simulation.scene(), false, true);
        simulation.run_metered(on(backend, 5_000, 500), dt, &mut meter).expect("steps");
        let gained = simulation.energy().expect("energies").total() - before;
        assert!(gained > 0.2 * before, "{law}, {integrator}: {gained} of {before}");
        let tolerance = if law == ContactLaw::Thesis { 0.01 } else { on(backend, 0.01, 0.03) };
        close(meter.work, gained, tolerance * gained, &format!("{law}, {integrator}: work"));
    }
}

/// A belt at U does the work 2 m U²/7 on a ball until it rolls, of which the ball gets half.
fn a_belt_does_twice_the_work_that_a_ball_keeps(backend: Backend) {
    let (mut scene, hard) = grains(ContactLaw::Linear, 0.1, 0.4, 10.0);
    let belt = Cuboid::between([-3.0, -0.1, -3.0], [3.0, 0.0, 3.0]).surface_velocity([0.7, 0.0, 0.0]);
    scene.add_box(belt.material(hard)).expect("a valid box");
    let overlap = 0.5 * 10.0 / 1e4;
    scene.add_sphere(Sphere::new([0.0, 0.05 - overlap, 0.0], 0.05).mass(0.5).material(hard)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let mut meter = Meter::new(simulation.scene(), false, true);
    simulation.run_metered(on(backend, 8_000, 800), on(backend, 2e-5, 2e-4), &mut meter).expect("steps");
    let expected = 2.0 * 0.5 * 0.49 / 7.0;
    close(meter.work, expected, 0.02 * expected, "work");
    near(simulation.spheres().expect("states")[0].velocity, [0.2, 0.0, 0.0], 3e-3, "velocity");
}

/// What a muscle does is what two balls gain.
fn a_muscle_does_the_work_that_balls_gain(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 0.0);
    let [one, two] = spheres(&mut scene, [0.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)));
    scene.add_spring(Spring::new(one, two, 20.0, 1.0).muscle(Muscle::new(0.2, 1.0, 0.0))).expect("a valid spring");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    let mut meter = Meter::new(simulation.scene(), false, true);
    simulation.run_metered(on(backend, 600, 150), on(backend, 0.001, 0.004), &mut meter).expect("steps");
    let energy = simulation.energy().expect("energies").total();
    assert!(energy > 0.1, "{energy}");
    close(meter.work, energy, 0.005 * energy, "work");
}

/// A wall that goes away takes its gauge along, with an error.
fn a_gauge_without_its_wall_is_an_error(backend: Backend) {
    let mut scene = Scene::new();
    let wall = scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0])).expect("a valid box");
    scene.set_tag(wall, Tag::new().name("floor")).expect("a valid tag");
    scene.add_sphere(Sphere::new([0.0, 1.0, 0.0], 0.1)).expect("a valid sphere");
    scene.add_gauge(Gauge::wall("weight", "floor")).expect("a valid gauge");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    assert_eq!(loads(&mut simulation), [WallLoad::default()]);
    simulation.remove_box(wall).expect("a box");
    assert!(simulation.gauges().expect_err("no wall").to_string().contains("'floor'"));
}

both! {
    a_bin_bears_the_weight_of_a_pile,
    a_disk_feels_the_friction_of_balls,
    planes_count_what_passes,
    planes_count_each_round,
    a_piston_does_the_work_that_grains_gain,
    a_belt_does_twice_the_work_that_a_ball_keeps,
    a_muscle_does_the_work_that_balls_gain,
    a_gauge_without_its_wall_is_an_error,
}
