//! Steps so short that an increment of a velocity is a small part of its last place (docs/physics section 5.10).

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, Checkpoint, ContactLaw, ForceInput, ForceLaw, ForceLoad, Integrator, Material, Options, Pair,
    Placement, Scene, Shape, Simulation, Sphere, SphereId,
};

use crate::common::{bits_of, on, with};

both! {
    every_acceleration_and_torque_is_felt,
    a_resumed_run_in_sorted_memory_has_the_same_bits,
    an_edit_of_one_sphere_leaves_the_others_alone,
    long_and_short_steps_follow_each_other,
    a_free_flight_keeps_its_velocity,
}

const GRAVITY: f64 = 9.81;
const TORQUE: f32 = 3.7;
const SPEEDS: [f32; 3] = [1.0, 20.0, 100.0];

/// A torque on every sphere.
fn twist() -> ForceLaw {
    let function = |_: &ForceInput<'_>| ForceLoad { force: Vec3::ZERO, torque: Vec3::new(0.0, 0.0, TORQUE) };
    ForceLaw::new("twist").wgsl("torque = vec3f(0.0, 0.0, 3.7);").function(function)
}

/// Spheres that are apart, with the speeds along y and as spins about z, and under a law with history a rigid body of two balls
/// with the second speed.
fn flight(law: ContactLaw) -> Scene {
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        settings.gravity = GRAVITY as f32;
    });
    let stuff = scene.add_material(Material::new("stuff").density(2500.0).young(1e9).poisson(0.3)).unwrap();
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.5).friction(0.3).stiffness(1e4)).unwrap();
    for (x, speed) in [0.0, 10.0, 20.0].into_iter().zip(SPEEDS) {
        for (z, speed) in [(0.0, -speed), (10.0, speed)] {
            let sphere =
                Sphere::new([x, 0.0, z], 0.5).mass(1.0).velocity([0.3, speed, 0.0]).angular_momentum([0.0, 0.0, speed]);
            scene.add_sphere(sphere.material(stuff)).unwrap();
        }
    }
    if law == ContactLaw::Thesis {
        return scene;
    }
    let dimer = Shape::new().material(stuff).sphere([-0.4, 0.0, 0.0], 0.5).sphere([0.4, 0.0, 0.0], 0.5).mass(2.0);
    let dimer = scene.add_shape(dimer).unwrap();
    let placed = Placement::new(dimer).at([0.0, 0.0, 30.0]).velocity([0.0, -20.0, 0.0]).angular_momentum([0.0, 0.0, 20.0]);
    scene.add_body(placed).unwrap();
    scene
}

fn open(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator).broad_phase(BroadPhase::Grid).force_law(twist());
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// Velocity and angular momentum of the single spheres, then of the body.
fn motions(simulation: &mut Simulation) -> Vec<[DVec3; 2]> {
    let scene = simulation.sync().expect("the state");
    let spheres = scene.spheres()[..6].iter().map(|sphere| [sphere.velocity, sphere.angular_momentum]);
    let bodies = scene.bodies().iter().map(|body| [body.velocity, body.angular_momentum]);
    spheres.chain(bodies).map(|motion| motion.map(|vector| vector.as_dvec3())).collect()
}

/// What a number gained, against what it must gain: to 0.1 %, and to half of its last place at the end.
#[track_caller]
fn assert_gained(before: f64, after: f64, gain: f64, what: &str) {
    let last_place = f64::from((after as f32).abs().next_up()) - after.abs();
    let error = (after - before - gain).abs();
    assert!(error <= 1e-3 * gain.abs() + 0.51 * last_place, "{what}: gained {}, expected {gain}", after - before);
}

#[track_caller]
fn assert_felt(before: &[[DVec3; 2]], after: &[[DVec3; 2]], time: f64, what: &str) {
    for (number, (before, after)) in before.iter().zip(after).enumerate() {
        let torque = f64::from(TORQUE) * if number == 6 { 2.0 } else { 1.0 };
        let what = format!("{what}, body {number} with {:?}", before[0]);
        assert_gained(before[0].y, after[0].y, -GRAVITY * time, &what);
        assert_gained(before[1].z, after[1].z, torque * time, &what);
        assert_eq!([before[0].x, before[0].z, before[1].x], [after[0].x, after[0].z, after[1].x], "{what}");
    }
}

fn every_acceleration_and_torque_is_felt(backend: Backend) {
    let [rk4, euler, verlet] = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];
    let all = [
        (ContactLaw::Thesis, rk4),
        (ContactLaw::HertzMindlin, verlet),
        (ContactLaw::Linear, euler),
        (ContactLaw::Thesis, verlet),
        (ContactLaw::Thesis, euler),
        (ContactLaw::Linear, verlet),
        (ContactLaw::HertzMindlin, euler),
    ];
    for (law, integrator) in all.into_iter().take(on(backend, 7, 3)) {
        for (dt, steps) in [(1e-8, on(backend, 40_000, 4_000)), (5e-7, 2_000), (1e-4, 200)] {
            let mut simulation = open(flight(law), backend, integrator);
            let before = motions(&mut simulation);
            simulation.run(steps, dt).expect("steps");
            let time = f64::from(dt) * steps as f64;
            assert_felt(&before, &motions(&mut simulation), time, &format!("{law}, {integrator}, {dt}"));
        }
    }
}

/// The residues of velocities are a part of the state: a checkpoint keeps them, and they follow their spheres.
fn a_resumed_run_in_sorted_memory_has_the_same_bits(backend: Backend) {
    for (law, integrator) in [
        (ContactLaw::HertzMindlin, Integrator::VelocityVerlet),
        (ContactLaw::Linear, Integrator::SymplecticEuler),
        (ContactLaw::Thesis, Integrator::Rk4),
    ] {
        let mut simulation = open(flight(law), backend, integrator);
        simulation.run(301, 1e-8).expect("steps");
        let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
        let mut checkpoint = Checkpoint::from_bytes(&bytes, "memory").expect("a valid checkpoint");
        checkpoint.give_force_law(twist()).expect("the law");
        let mut resumed = Simulation::resume(checkpoint).expect("a simulation");
        simulation.run(50, 1e-8).expect("steps");
        simulation.sort_memory().expect("a sort");
        simulation.run(50, 1e-8).expect("steps");
        resumed.run(100, 1e-8).expect("steps");
        assert_eq!(bits_of(&mut simulation), bits_of(&mut resumed), "{law}, {integrator}");
        let [one, other] = [&mut simulation, &mut resumed].map(|simulation| simulation.checkpoint().expect("a checkpoint"));
        assert_eq!(motions(&mut simulation), motions(&mut resumed), "{law}, {integrator}");
        let differing = one.to_bytes().len() - other.to_bytes().len();
        assert_eq!(differing, 0, "{law}, {integrator}: both have residues");
    }
}

/// A program that sets the velocity of one sphere every few steps takes nothing from the others.
fn an_edit_of_one_sphere_leaves_the_others_alone(backend: Backend) {
    let mut simulation = open(flight(ContactLaw::HertzMindlin), backend, Integrator::VelocityVerlet);
    let ids: Vec<SphereId> = simulation.scene().sphere_ids().collect();
    let before = motions(&mut simulation);
    let rounds = on(backend, 500, 100);
    for round in 0..rounds {
        simulation.set_velocity(ids[0], [0.3, -1.0, 0.0]).expect("an edit");
        if round % 50 == 7 {
            // The scene is packed again.
            let sphere = Sphere::new([0.0, 0.0, 60.0 + round as f32], 0.1).density(1000.0);
            let material = simulation.scene().sphere(ids[1]).expect("a sphere").material.expect("a material");
            simulation.add_sphere(sphere.material(material)).expect("a valid sphere");
        }
        simulation.run(5, 5e-7).expect("steps");
    }
    let (after, time) = (motions(&mut simulation), 5e-7 * 5.0 * f64::from(rounds));
    assert_felt(&before[1..6], &after[1..6], time, "edits");
    assert_gained(-1.0, after[0][0].y, -GRAVITY * 5.0 * 5e-7, "the edited sphere");
}

/// Arrays get room for residues and lose it between two steps.
fn long_and_short_steps_follow_each_other(backend: Backend) {
    let mut simulation = open(flight(ContactLaw::HertzMindlin), backend, Integrator::VelocityVerlet);
    let before = motions(&mut simulation);
    let mut time = 0.0;
    for _ in 0..3 {
        for (dt, steps) in [(1e-3, 5), (5e-7, 400)] {
            simulation.run(steps, dt).expect("steps");
            time += f64::from(dt) * steps as f64;
        }
    }
    let after = motions(&mut simulation);
    for (before, after) in before.iter().zip(&after) {
        assert_gained(before[0].y, after[0].y, -GRAVITY * time, "velocity");
    }
}

/// Without forces, no bit of a velocity changes.
fn a_free_flight_keeps_its_velocity(backend: Backend) {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let mut scene = flight(ContactLaw::Thesis);
        scene.settings.gravity = 0.0;
        let options = Options::new().backend(backend).integrator(integrator);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        let before = motions(&mut simulation);
        simulation.run(100, 1e-6).expect("steps");
        assert_eq!(before, motions(&mut simulation), "{integrator}");
    }
}
