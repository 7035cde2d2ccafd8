//! Capsules are rigid bodies under laws with history (E30, docs/physics section 1.6).

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Integrator, Simulation};

use super::scenes::{opened, scene, within};
use crate::common::on;

const FLOOR: &str = "B -3 -1 -3  6 0 0  0 1 0  0 0 6\n";
const BOUNCY: &str = "set gravity 0\nset contact_law hertz-mindlin\n@material a density=1000 young=1e7 poisson=0.3\n\
                      @pair a a restitution=0.5 friction=0\n@use a\n";
/// A slope of 15 degrees.
const ROUGH: &str = "set gravity 9.81\nset gravity_direction 0.25881904510252074 -0.9659258262890683 0\n\
                     set contact_law hertz-mindlin\n@material a density=1000 young=1e7 poisson=0.3\n\
                     @pair a a restitution=0.3 friction=0.5\n@use a\n";
fn start(text: &str, backend: Backend) -> Simulation {
    opened(scene(text), backend, Integrator::VelocityVerlet)
}

fn mean(simulation: &mut Simulation, of: fn(&rockfall::SphereState) -> Vec3) -> Vec3 {
    let spheres = simulation.spheres().expect("spheres");
    spheres.iter().map(of).sum::<Vec3>() / spheres.len() as f32
}

/// A capsule that falls at 1 on a floor leaves it at 0.5. It left at 0.60.
fn e30_capsules_are_rigid_bodies_under_laws_with_history(backend: Backend) {
    let capsule = "C 0 0.1002 0  0 0.7002 0  0 -1 0  - 0.1\n";
    let mut simulation = start(&format!("{BOUNCY}{FLOOR}{capsule}"), backend);
    simulation.run(1_200, 5e-5).expect("steps");
    assert!(simulation.contacts().expect("contacts").is_empty(), "the capsule must have left");
    within(mean(&mut simulation, |sphere| sphere.velocity).y.into(), 0.5, 5e-3, "capsule");
}

/// What lies on a slope of 15 degrees with friction 0.5 stays. The capsule crept at 1e-4 units/s.
fn e30_a_capsule_stays_on_a_slope(backend: Backend) {
    let capsule = "C -0.3 0.0999 0  0.3 0.0999 0  0 0 0  - 0.1\n";
    let mut simulation = start(&format!("{ROUGH}{FLOOR}{capsule}"), backend);
    let place = |sphere: &rockfall::SphereState| sphere.position;
    let (steps, parts) = on(backend, (10_000, 2), (500, 1));
    // It settles first.
    simulation.run(steps, 1e-4).expect("steps");
    let before = mean(&mut simulation, place);
    for _ in 0..parts {
        simulation.run(steps, 1e-4).expect("steps");
    }
    let way = mean(&mut simulation, place).distance(before);
    let allowed = on(backend, 5e-7, 1e-4);
    assert!(way < allowed, "it moved by {way}");
}

/// A capsule with r = 1, l = 4 and mass 1 that a couple turns: its moment of inertia across the axis is 2.6625, not 4.4 (that of two balls).
fn e30_a_couple_turns_a_capsule_as_a_solid(backend: Backend) {
    let text = "set gravity 0\nset contact_law hertz-mindlin\n@material g density=1 young=1e6 poisson=0.25\n\
                @pair g g restitution=0.5 friction=0.3\n@use g\nS 1 -2 0 0 0 0 0 0 0 0 0.5 1\nS 2 2 0 0 0 0 0 0 0 0 0.5 1\n\
                R 1 2 1 4\n@force 1 0 -0.001 0\n@force 2 0 0.001 0\n";
    let mut simulation = start(text, backend);
    simulation.run(100, 1e-2).expect("steps");
    let spheres = simulation.spheres().expect("spheres");
    within(f64::from(spheres[1].velocity.y / 2.0), 0.004 / 2.6625, 2e-6, "angular velocity");
}

/// The motion of one end that is set between steps becomes that of the body, and an edit of nothing else changes no bit of a run.
fn e30_the_parts_of_a_body_are_changed_as_before(backend: Backend) {
    let text = "set gravity 0\nset contact_law linear\n@material a density=1000\n@pair a a stiffness=1e5\n@use a\nC -0.5 0 0 0.5 0 0 0 0 0 2 0.25\n";
    let mut simulation = start(text, backend);
    simulation.run(3, 1e-3).expect("steps");
    let ends: Vec<_> = simulation.scene().sphere_ids().collect();
    simulation.set_velocity(ends[1], [0.0, 2.0, 0.0]).expect("a velocity");
    simulation.run(1, 1e-3).expect("steps");
    let energy = simulation.energy().expect("energies");
    within(energy.momentum.y, 2.0, 1e-6, "momentum");
    // An orientation of both ends that turns x along the rod stays, another one is replaced by one that does.
    let way = |simulation: &mut Simulation| {
        let spheres = simulation.spheres().expect("spheres");
        ((spheres[1].position - spheres[0].position).normalize(), spheres[1].orientation)
    };
    let (along, before) = way(&mut simulation);
    let rolled = Quat::from_axis_angle(along, 0.7) * before;
    for (given, expected) in [([rolled, rolled], rolled), ([rolled, before], Quat::from_rotation_arc(Vec3::X, along))] {
        ends.iter().zip(given).for_each(|(end, turn)| simulation.set_orientation(*end, turn).expect("an orientation"));
        let (_, found) = way(&mut simulation);
        assert!(found.dot(expected).abs() > 1.0 - 1e-6, "{found} {expected}");
    }
    let scene = simulation.scene();
    let text = scene.to_text();
    assert!(scene.bodies().is_empty() && !text.contains("@body") && text.contains("@capsule"), "{text}");
    simulation.remove_sphere(ends[0]).expect("one end");
    simulation.run(1, 1e-3).expect("steps");
    assert_eq!(simulation.scene().spheres().len(), 1);
}

/// A run that is resumed from a file has the same bits.
fn e30_a_resumed_run_has_the_same_bits(backend: Backend) {
    let mut simulation = start(&format!("{ROUGH}{FLOOR}C 0.8 0.2 0  1.2 0.3 0  0 0 0  - 0.1\n"), backend);
    simulation.run(150, 1e-4).expect("steps");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    simulation.run(150, 1e-4).expect("steps");
    let read = rockfall::Checkpoint::from_bytes(&bytes, "memory").expect("a checkpoint");
    let mut resumed = Simulation::resume(read).expect("a simulation");
    resumed.run(150, 1e-4).expect("steps");
    assert_eq!(format!("{:?}", simulation.spheres().expect("spheres")), format!("{:?}", resumed.spheres().expect("spheres")));
}

both! {
    e30_capsules_are_rigid_bodies_under_laws_with_history,
    e30_a_capsule_stays_on_a_slope,
    e30_a_couple_turns_a_capsule_as_a_solid,
    e30_the_parts_of_a_body_are_changed_as_before,
    e30_a_resumed_run_has_the_same_bits,
}
