//! The springs of contacts survive list rebuilds, sorted memory, growth, edits and checkpoints, bit for bit.

use rockfall::{
    Backend, BroadPhase, Capsule, Checkpoint, CohesionModel, ContactLaw, Cuboid, Integrator, Pair, Rod, Scene, Simulation,
    Sphere,
};

use super::{ball, options, pair, scene_with, simulation, soft};
use crate::common::bits_of;

/// Balls of two sizes, capsules and a rod of free length fall into a walled box with strong friction. With a surface energy
/// they have JKR cohesion.
fn crowd(law: ContactLaw, gamma: f32, balls: u8) -> Scene {
    let mut scene = scene_with(law);
    scene.settings.gravity = 10.0;
    let material = soft(&mut scene, "soft");
    let properties = Pair::default().restitution(0.3).friction(0.6).stiffness(1e4);
    let properties = properties.surface_energy(gamma).cohesion(CohesionModel::Jkr);
    scene.set_pair(material, material, properties.rolling_friction(0.1).twisting_friction(0.3)).expect("a valid pair");
    for (low, high) in [
        ([-3.0, -1.0, -3.0], [3.0, 0.0, 3.0]),
        ([-3.0, 0.0, -3.0], [-2.0, 6.0, 3.0]),
        ([2.0, 0.0, -3.0], [3.0, 6.0, 3.0]),
        ([-3.0, 0.0, -3.0], [3.0, 6.0, -2.0]),
        ([-3.0, 0.0, 2.0], [3.0, 6.0, 3.0]),
    ] {
        scene.add_box(Cuboid::between(low, high).material(material)).expect("a valid box");
    }
    for k in 0..balls {
        let (x, z, y) = (f32::from(k % 3), f32::from(k / 3 % 3), f32::from(k / 9));
        let radius = if k % 4 == 1 { 0.25 } else { 0.5 };
        let position = [1.15 * x - 1.2 + 0.05 * z, 0.55 + 1.05 * y, 1.15 * z - 1.2 + 0.03 * y];
        scene.add_sphere(ball(&scene, material, position, radius).velocity([0.3 * x, -1.0, 0.2])).expect("a valid sphere");
    }
    if gamma > 0.0 {
        // A ball that hangs by a neck, at 0.92 of the pull-off force.
        scene.add_sphere(ball(&scene, material, [8.0, 3.0, 0.0], 0.5).fixed()).expect("a valid sphere");
        let hanging = ball(&scene, material, [8.0, 3.0 - 0.7999, 0.0], 0.3);
        let pull = 0.92 * 3.0 * std::f32::consts::PI * gamma * (0.5 * 0.3 / 0.8) - 10.0 * hanging.mass;
        scene.add_sphere(hanging.force([0.0, -pull, 0.0])).expect("a valid sphere");
    }
    let top = 1.5 + 1.05 * f32::from(balls / 9);
    let capsule = Capsule::new([-1.0, top, 0.1], [0.5, top + 0.3, 0.4], 0.3).density(1.0).velocity([0.0, -2.0, 0.0]);
    scene.add_capsule(capsule.material(material)).expect("a valid capsule");
    let ends = [[-0.5, top + 1.2, -0.8], [0.9, top + 1.0, -0.6]].map(|place| ball(&scene, material, place, 0.25));
    let [one, two] = ends.map(|end: Sphere| scene.add_sphere(end).expect("a valid sphere"));
    scene.add_rod(Rod::new(one, two, 0.2).material(material)).expect("a valid rod");
    scene
}

fn opened(scene: &Scene, backend: Backend, method: BroadPhase, integrator: Integrator) -> Simulation {
    let options = options(backend).broad_phase(method).integrator(integrator);
    Simulation::with_options(scene.clone(), options).expect("the simulation opens")
}

/// The result does not depend on the broad phase, on how often memory is sorted, or on how a run is divided and resumed.
fn springs_are_kept_bit_for_bit(backend: Backend) {
    let (steps, balls, dt) = crate::common::on(backend, (3000_u64, 27, 2e-4), (320, 9, 5e-4));
    let (euler, verlet) = (Integrator::SymplecticEuler, Integrator::VelocityVerlet);
    for (law, gamma, integrator) in [
        (ContactLaw::Linear, 0.0, euler),
        (ContactLaw::HertzMindlin, 0.0, euler),
        (ContactLaw::HertzMindlin, 0.0, verlet),
        (ContactLaw::HertzMindlin, 20.0, verlet),
    ] {
        let scene = crowd(law, gamma, balls);
        let mut necks = 0;
        let mut whole = opened(&scene, backend, BroadPhase::Grid, integrator);
        whole.run(steps, dt).expect("steps");
        let expected = bits_of(&mut whole);
        let report = whole.report();
        assert!(report.contacts > 5 && report.list_builds < steps, "{report:?}");
        for method in [BroadPhase::BruteForce, BroadPhase::SortAndSkip] {
            let mut other = opened(&scene, backend, method, integrator);
            other.run(steps, dt).expect("steps");
            assert!(bits_of(&mut other) == expected, "{law}, {integrator}, {method}");
        }
        let mut parts = opened(&scene, backend, BroadPhase::Grid, integrator);
        for part in 0..4 {
            parts.run(steps / 4, dt).expect("steps");
            necks += parts.contacts().expect("contacts").iter().filter(|contact| contact.overlap < 0.0).count();
            match part {
                0 => parts.sort_memory().expect("sorted memory"),
                1 => {
                    let bytes = parts.checkpoint().expect("a checkpoint").to_bytes();
                    parts = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("valid")).expect("resumed");
                }
                2 => {
                    let checkpoint = parts.checkpoint().expect("a checkpoint");
                    parts.run(3, dt).expect("steps");
                    parts.restore(&checkpoint).expect("restored");
                }
                _ => {}
            }
        }
        assert!(bits_of(&mut parts) == expected, "{law}, {integrator}, in parts");
        // Contacts of bodies that are apart are kept with the others.
        assert_eq!(necks > 0, gamma > 0.0, "{necks} necks");
    }
}

/// A ball that holds a weight on an incline by static friction alone goes on holding it when objects that were added before it
/// are removed and others are added. Without its springs it would slip by their length.
fn edits_keep_springs(backend: Backend) {
    let law = ContactLaw::HertzMindlin;
    let mut scene = scene_with(law);
    scene.settings.gravity = 10.0;
    scene.settings.gravity_direction = glam::Vec3::new(0.3, -0.95, 0.0).normalize();
    let material = soft(&mut scene, "soft");
    pair(&mut scene, material, material, 0.1, 0.5);
    let far = scene.add_sphere(ball(&scene, material, [50.0, 0.0, 0.0], 0.5).fixed()).expect("a valid sphere");
    let old_box = scene.add_box(Cuboid::between([60.0, 0.0, 0.0], [61.0, 1.0, 1.0]).material(material)).expect("a box");
    scene.add_box(Cuboid::between([-5.0, -1.0, -2.0], [5.0, 0.0, 2.0]).material(material)).expect("a valid box");
    let capsule = Capsule::new([0.0, 0.499, 0.0], [2.0, 0.499, 0.0], 0.5).density(1.0).material(material);
    scene.add_capsule(capsule).expect("a valid capsule");
    let (steps, dt) = crate::common::on(backend, (6000, 2.5e-4), (400, 1e-3));
    let mut simulation = simulation(scene, backend);
    simulation.run(steps, dt).expect("steps");
    let x = |simulation: &mut Simulation| {
        let scene = simulation.sync().expect("the state");
        let end = scene.capsules()[0].end1;
        scene.sphere(end).expect("an end").position.x
    };
    let before = x(&mut simulation);
    simulation.remove_sphere(far).expect("removed");
    simulation.remove_box(old_box).expect("removed");
    simulation.add_sphere(Sphere::new([70.0, 0.0, 0.0], 0.5).fixed().material(material)).expect("added");
    simulation.run(steps / 4, dt).expect("steps");
    let moved = (x(&mut simulation) - before).abs();
    // g sin / (2 S_t / m) is the length of the springs: about 2e-4. The capsule creeps at 1e-4 units/s.
    let allowed = 5e-5;
    assert!(moved < allowed, "moved by {moved}");
}

/// A ball among twelve equal ones owns more springs than a block holds.
fn the_pool_grows_for_many_contacts(backend: Backend) {
    let law = ContactLaw::Linear;
    let mut scene = scene_with(law);
    let material = soft(&mut scene, "soft");
    pair(&mut scene, material, material, 0.5, 0.5);
    scene.add_sphere(ball(&scene, material, [0.0; 3], 0.5)).expect("a valid sphere");
    for (a, b) in [(1.0_f32, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        for place in [[a, b, 0.0], [a, 0.0, b], [0.0, a, b]] {
            let position = place.map(|k: f32| 0.99 * k * 0.5_f32.sqrt());
            scene.add_sphere(ball(&scene, material, position, 0.5)).expect("a valid sphere");
        }
    }
    let mut simulation = simulation(scene, backend);
    let report = simulation.run(3, 1e-4).expect("steps");
    assert!(report.contacts >= 12 && report.replays > 0, "{report:?}");
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    let mut resumed = Simulation::resume(checkpoint).expect("resumed");
    for simulation in [&mut simulation, &mut resumed] {
        simulation.run(5, 1e-4).expect("steps");
    }
    assert!(bits_of(&mut simulation) == bits_of(&mut resumed));
}

/// Another direction of gravity takes effect at once and does not pack the scene again. The result is that of a scene whose table
/// of pairs is packed again at the same steps.
fn gravity_turns_while_contacts_last(backend: Backend) {
    let (steps, balls) = crate::common::on(backend, (100, 18), (50, 9));
    let scene = crowd(ContactLaw::HertzMindlin, 0.0, balls);
    let material = scene.find_material("soft").expect("a material");
    let turned = |packs: bool, turns: bool| {
        let mut simulation = opened(&scene, backend, BroadPhase::Auto, Integrator::VelocityVerlet);
        for part in 0..8_u8 {
            simulation.run(steps, 5e-4).expect("steps");
            let mut settings = *simulation.settings();
            let angle = if turns { 0.1 * f32::from(part + 1) } else { 0.0 };
            settings.gravity_direction = glam::Vec3::new(angle.sin(), -angle.cos(), 0.0);
            simulation.set_settings(settings).expect("valid settings");
            if packs {
                simulation.update_material(material, |_| {}).expect("a material");
            }
        }
        simulation.run(steps, 5e-4).expect("steps");
        bits_of(&mut simulation)
    };
    let found = turned(false, true);
    assert!(found == turned(true, true), "the same bits as with packing");
    assert!(found != turned(false, false), "gravity has an effect");
}

both!(springs_are_kept_bit_for_bit, edits_keep_springs, the_pool_grows_for_many_contacts, gravity_turns_while_contacts_last);
