//! Walls that seek a force or a torque (docs/physics section 2.18).

use rockfall::glam::DVec3;
use rockfall::{
    Backend, BroadPhase, Checkpoint, ContactLaw, Cuboid, Integrator, Material, Meter, Motion, MotionId, MotionTerm, Options,
    Pair, Scene, Servo, Simulation, Sphere, Worlds,
};

use crate::common::{close, near, open, with};

/// Normal stiffness of the contacts of the pack.
const STIFFNESS: f32 = 1000.0;
/// Columns of the pack along each side, and balls of a column.
const SIDE: u16 = 3;
const LAYERS: u16 = 2;
/// Part of the error of the force that is corrected in a step.
const GAIN: f64 = 0.25;

fn servo(simulation: &mut Simulation, id: MotionId) -> Servo {
    simulation.sync().expect("a state").motion(id).expect("a motion").servo.expect("a servo")
}

/// Balls of radius 0.5 in columns on a floor, without gravity, below a plate whose lower face is `gap` above them.
fn pack(law: ContactLaw, mass: f32, gap: f32, plate: Servo) -> (Scene, MotionId) {
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.contact_law, scene.settings.collisions) = (0.0, law, false);
    let rubber = scene.add_material(Material::new("rubber").density(1.0)).expect("a valid material");
    let pair = Pair::default().stiffness(STIFFNESS).restitution(1.0).friction(0.0);
    scene.set_pair(rubber, rubber, pair).expect("a valid pair");
    let reach = f32::from(SIDE) + 1.0;
    scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [reach, 0.0, reach]).material(rubber)).expect("a valid box");
    let id = scene.add_motion(Motion::servo("plate", plate)).expect("a valid motion");
    let top = f32::from(LAYERS) + gap;
    let lid = Cuboid::between([-1.0, top, -1.0], [reach, top + 1.0, reach]).material(rubber).motion(id);
    scene.add_box(lid).expect("a valid box");
    for k in 0..SIDE * SIDE * LAYERS {
        let [x, y, z] = [k % SIDE, k / (SIDE * SIDE), k / SIDE % SIDE].map(|place| f32::from(place) + 0.5);
        scene.add_sphere(Sphere::new([x, y, z], 0.5).mass(mass).material(rubber)).expect("a valid sphere");
    }
    (scene, id)
}

fn a_plate_reaches_its_force_and_stays(backend: Backend) {
    let (mut scene, id) = pack(ContactLaw::Linear, 1.0, 0.01, Servo::force([0.0, -90.0, 0.0], 0.5));
    scene.settings.linear_damping = 5.0;
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(4000, 0.002).expect("steps");
    let load = simulation.wall_load("plate").expect("a load");
    let plate = servo(&mut simulation, id);
    near(load.force, DVec3::new(0.0, 90.0, 0.0), 0.02, "force");
    // Each of nine columns carries 10, and has three springs in a row.
    let expected = 0.01 + 3.0 * 10.0 / f64::from(STIFFNESS);
    assert!((plate.displacement - expected).abs() < 1e-5, "{plate:?}");
    assert!(plate.velocity.abs() < 1e-3, "{plate:?}");
    // The load is that of the state that is read, whatever was read before.
    simulation.run(1, 0.002).expect("a step");
    near(simulation.wall_load("plate").expect("a load").force, DVec3::new(0.0, 90.0, 0.0), 0.02, "force");
}

/// The errors of the force after each step on balls that are so heavy that they stand still, as parts of the target. The plate begins
/// with half of its force.
fn errors(backend: Backend, law: ContactLaw, integrator: Integrator, steps: usize) -> Vec<f64> {
    let columns = f64::from(SIDE * SIDE);
    let heavy = 1e9_f32;
    let (mut scene, id) = pack(law, heavy, 0.0, Servo::force([0.0, -90.0, 0.0], 1e3));
    (scene.settings.contact_force, scene.settings.contact_damping) = (STIFFNESS / heavy, 0.0);
    let half = 5.0 / f64::from(STIFFNESS);
    let place = |motion: &mut Motion| motion.servo.as_mut().expect("a servo").displacement = half;
    scene.update_motion(id, place).expect("a valid displacement");
    let mut simulation = open(scene, backend, integrator);
    let mut errors = Vec::new();
    for _ in 0..steps {
        simulation.run(1, 0.002).expect("a step");
        let force = columns * f64::from(STIFFNESS) * servo(&mut simulation, id).displacement;
        errors.push(1.0 - force / 90.0);
    }
    errors
}

/// With the forces at the end of a step, the error becomes smaller by the factor 1 - alpha in every step. The plate begins to move after
/// the first step.
fn the_error_decays_by_a_factor(backend: Backend) {
    let found = errors(backend, ContactLaw::Linear, Integrator::VelocityVerlet, 14);
    for (step, error) in found.iter().enumerate() {
        close(*error, 0.5 * (1.0 - GAIN).powi(step as i32), 2e-5, &format!("step {step}"));
    }
}

/// With forces that are one step old, e'' - e' + alpha e = 0. At alpha = 1/4 that is critical: from rest e = (1 + n/2) 2^-n, without an
/// overshoot.
fn an_error_that_is_one_step_old_decays_without_an_overshoot(backend: Backend) {
    for (law, integrator) in [
        (ContactLaw::Linear, Integrator::SymplecticEuler),
        (ContactLaw::Thesis, Integrator::SymplecticEuler),
        (ContactLaw::Thesis, Integrator::Rk4),
    ] {
        let found = errors(backend, law, integrator, 16);
        for (step, error) in found.iter().enumerate() {
            let n = step as i32;
            close(*error, 0.5 * (1.0 + 0.5 * f64::from(n)) * 0.5_f64.powi(n), 2e-5, &format!("{law} {integrator} step {step}"));
        }
    }
}

/// A vane on a shaft presses against a ball that a post holds.
fn vane(law: ContactLaw, shaft: Servo) -> (Scene, MotionId) {
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.contact_law, scene.settings.collisions) = (0.0, law, false);
    let steel = scene.add_material(Material::new("steel").density(1.0).young(1e5).poisson(0.3)).expect("a valid material");
    scene.set_pair(steel, steel, Pair::default().restitution(0.5).friction(0.0).stiffness(STIFFNESS)).expect("a valid pair");
    let id = scene.add_motion(Motion::servo("shaft", shaft)).expect("a valid motion");
    let blade = Cuboid::between([1.0, -0.2, -1.0], [5.0, -0.1, 1.0]).material(steel).motion(id);
    scene.add_box(blade).expect("a valid box");
    scene.add_box(Cuboid::between([2.0, 1.0, -1.0], [4.0, 1.5, 1.0]).material(steel)).expect("a valid box");
    scene.add_sphere(Sphere::new([3.0, 0.5, 0.0], 0.5).mass(1.0).material(steel)).expect("a valid sphere");
    (scene, id)
}

fn a_shaft_reaches_its_torque(backend: Backend) {
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let (mut scene, id) = vane(law, Servo::torque(30.0, DVec3::Z, DVec3::ZERO, 1.0));
        scene.settings.linear_damping = 20.0;
        // The ball stays where the blade is at right angles to its arm.
        let ball = scene.sphere_ids().next().expect("a ball");
        scene.add_tether(rockfall::Tether::new(ball, [3.0, 0.5, 0.0], 1e4).damping(50.0)).expect("a valid tether");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(3000, 0.001).expect("steps");
        let load = simulation.wall_load("shaft").expect("a load");
        let shaft = servo(&mut simulation, id);
        close(load.torque.z, -30.0, 0.02, &format!("{law} torque"));
        assert!((0.03..0.2).contains(&shaft.displacement) && shaft.velocity.abs() < 1e-3, "{law}: {shaft:?}");
    }
}

/// Without bodies a wall moves at its greatest speed, for ever and in the direction of what it seeks.
fn walls_without_contacts_move_at_their_speed(backend: Backend) {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([50.0, 0.0, 0.0], 0.5)).expect("a valid sphere");
    scene.settings.gravity = 0.0;
    let servos = [
        Servo::force([3.0, 0.0, -4.0], 2.0),
        Servo::torque(-1.0, DVec3::Y, DVec3::X, 6.0),
        Servo::torque(0.0, DVec3::Y, DVec3::X, 6.0),
    ];
    let ids = [0, 1, 2].map(|k| {
        let id = scene.add_motion(Motion::servo(format!("servo{k}"), servos[k])).expect("a valid motion");
        scene.add_box(Cuboid::between([0.0; 3], [1.0; 3]).motion(id)).expect("a valid box");
        id
    });
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut simulation = open(scene.clone(), backend, integrator);
        simulation.run(1001, 0.01).expect("steps");
        for (id, (speed, way)) in ids.into_iter().zip([(2.0, 20.0), (-6.0, -60.0), (0.0, 0.0)]) {
            let servo = servo(&mut simulation, id);
            close(servo.velocity, speed, 0.0, "speed");
            close(servo.displacement, way, 1e-4, "way");
        }
    }
}

/// The bits of a state: of balls and servos.
fn bits(simulation: &mut Simulation, id: MotionId) -> Vec<u64> {
    let plate = servo(simulation, id);
    let spheres = simulation.spheres().expect("a state").to_vec();
    let balls = spheres.iter().flat_map(|ball| [ball.position.to_array(), ball.velocity.to_array()].concat());
    let balls = balls.map(|x| u64::from(x.to_bits()));
    balls.chain([plate.displacement.to_bits(), plate.velocity.to_bits()]).collect()
}

fn bits_depend_neither_on_lists_nor_on_interruptions(backend: Backend) {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let (scene, id) = pack(ContactLaw::Linear, 1.0, 0.02, Servo::force([5.0, -90.0, 0.0], 0.5));
        let with = |broad_phase| {
            let options = Options::new().backend(backend).integrator(integrator).broad_phase(broad_phase);
            Simulation::with_options(scene.clone(), options).expect("the simulation opens")
        };
        let mut whole = with(BroadPhase::BruteForce);
        whole.run(60, 0.002).expect("steps");
        let expected = bits(&mut whole, id);
        let mut parts = with(BroadPhase::Grid);
        for _ in 0..20 {
            parts.run(3, 0.002).expect("steps");
            parts.wall_load("plate").expect("a load");
        }
        assert_eq!(bits(&mut parts, id), expected, "{integrator}");
        // A checkpoint in the middle.
        let mut first = with(BroadPhase::SortAndSkip);
        first.run(31, 0.002).expect("steps");
        let bytes = first.checkpoint().expect("a checkpoint").to_bytes();
        let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("a checkpoint")).expect("resumes");
        resumed.run(29, 0.002).expect("steps");
        let id = resumed.scene().find_motion("plate").expect("the plate");
        assert_eq!(bits(&mut resumed, id), expected, "{integrator}");
    }
}

/// The work of the plate is what the springs and the balls have.
fn the_work_of_a_servo_is_the_energy_of_the_pack(backend: Backend) {
    let (scene, _) = pack(ContactLaw::Linear, 1.0, 0.01, Servo::force([0.0, -90.0, 0.0], 0.5));
    let mut meter = Meter::new(&scene, false, true);
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run_metered(300, 0.0005, &mut meter).expect("steps");
    let energy = simulation.energy().expect("an energy");
    let total = energy.kinetic + energy.contact;
    assert!(total > 0.3, "{energy:?}");
    close(meter.work, total, 0.01 * total, "work");
}

/// Another target, and then a motion in place of the servo, without a jump.
fn a_servo_can_be_changed_while_it_runs(backend: Backend) {
    let (mut scene, id) = pack(ContactLaw::Linear, 1.0, 0.01, Servo::force([0.0, -90.0, 0.0], 0.5));
    scene.settings.linear_damping = 5.0;
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(2000, 0.002).expect("steps");
    let loaded = servo(&mut simulation, id).displacement;
    simulation.run(1, 0.002).expect("a step");
    let halve = |motion: &mut Motion| {
        let servo = motion.servo.as_mut().expect("a servo");
        assert!((servo.displacement - loaded).abs() < 1e-6, "{servo:?}");
        servo.seeks = rockfall::Sought::Force(DVec3::new(0.0, -45.0, 0.0));
    };
    simulation.update_motion(id, halve).expect("a valid servo");
    simulation.run(3000, 0.002).expect("steps");
    close(simulation.wall_load("plate").expect("a load").force.y, 45.0, 0.02, "half the force");
    close(servo(&mut simulation, id).displacement, 0.01 + 1.5 * 10.0 / f64::from(STIFFNESS), 1e-5, "half the way");
    simulation.go_on(id, MotionTerm::translation([0.0, -0.001, 0.0])).expect("a valid term");
    simulation.run(500, 0.002).expect("steps");
    assert!(simulation.scene().motion(id).expect("a motion").servo.is_none());
    let further = 0.001 * f64::from(STIFFNESS) / 3.0 * f64::from(SIDE * SIDE);
    close(simulation.wall_load("plate").expect("a load").force.y, 45.0 + further, 0.1, "driven");
}

/// A collision sees the velocity of the wall: a ball at rest leaves an elastic plate at twice its speed.
fn collisions_see_the_velocity_of_a_servo(backend: Backend) {
    for continuous in [false, true] {
        let mut scene = with(|settings| {
            (settings.gravity, settings.restitution, settings.activation_threshold) = (0.0, 1.0, 0.0);
            (settings.friction, settings.contact_damping, settings.continuous_collisions) = (0.0, 0.0, continuous);
        });
        let id = scene.add_motion(Motion::servo("racket", Servo::force([5.0, 0.0, 0.0], 1.0))).expect("a valid motion");
        scene.add_box(Cuboid::between([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]).motion(id)).expect("a valid box");
        scene.add_sphere(Sphere::new([0.305, 0.0, 0.0], 0.1)).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        simulation.run(50, 0.01).expect("steps");
        let velocity = simulation.spheres().expect("a state")[0].velocity;
        near(velocity, [2.0, 0.0, 0.0], 1e-5, &format!("continuous {continuous}"));
        close(servo(&mut simulation, id).displacement, 0.49, 1e-6, "the impulse is no part of the force");
    }
}

/// Each world of a batch has servos of its own.
fn worlds_have_servos_of_their_own(backend: Backend) {
    let packs = [-90.0, -30.0].map(|force| pack(ContactLaw::Thesis, 1.0, 0.01, Servo::force([0.0, force, 0.0], 0.5)).0);
    let options = Options::new().backend(backend);
    let mut worlds = Worlds::new(packs.clone(), options.clone()).expect("worlds");
    worlds.run(60, 0.005).expect("steps");
    for (world, scene) in packs.into_iter().enumerate() {
        let mut alone = Simulation::with_options(scene, options.clone()).expect("the simulation opens");
        alone.run(60, 0.005).expect("steps");
        let (one, other) = (worlds.states(world).expect("states"), alone.spheres().expect("states"));
        assert!(one == other, "world {world}");
    }
}

both! {
    collisions_see_the_velocity_of_a_servo,
    worlds_have_servos_of_their_own,
    a_plate_reaches_its_force_and_stays,
    the_error_decays_by_a_factor,
    an_error_that_is_one_step_old_decays_without_an_overshoot,
    a_shaft_reaches_its_torque,
    walls_without_contacts_move_at_their_speed,
    bits_depend_neither_on_lists_nor_on_interruptions,
    the_work_of_a_servo_is_the_energy_of_the_pack,
    a_servo_can_be_changed_while_it_runs,
}
