//! Bodies that own more contacts than a block of springs holds (docs/buffers.md). Which blocks of the pool they take, and when the
//! pool grows, has no effect on results.

use rockfall::{Backend, BroadPhase, Capsule, Checkpoint, ContactLaw, Cuboid, Integrator, Pair, Scene, Simulation, glam::Vec3};

use super::{ball, options, pair, scene_with, soft};
use crate::common::bits_of;

/// Radius of the balls in troughs.
const RADIUS: f32 = 0.2;

/// The angles of the strips of a trough from the direction down, in rad. The first three hold a ball.
const ANGLES: [f32; 14] = [0.0, 0.5, -0.5, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.4, -0.4, 0.6, -0.6, 0.05];

/// A strip of a trough along x: a box whose face touches the circle of this radius about the axis of the trough, which begins at `begin`.
/// Of strips in one plane, a ball would touch one (docs/physics section 2.11).
fn strip(begin: Vec3, end: f32, radius: f32, angle: f32) -> Cuboid {
    let (sin, cos) = angle.sin_cos();
    let (down, across) = (Vec3::new(0.0, -cos, sin), Vec3::new(0.0, sin, cos));
    let half = 0.1 * radius;
    let corner = begin + radius * down + half * across;
    Cuboid::new(corner, (end - begin.x) * Vec3::X, half * down, -2.0 * half * across)
}

/// Balls that roll in troughs, and a capsule that rolls on a plate. Each strip of a trough begins a little further on than the one
/// before, so that a ball in motion touches more and more of them: from 3 up to 14. The first ball lies apart.
fn troughs(law: ContactLaw, with_rod: bool) -> Scene {
    let mut scene = scene_with(law);
    scene.settings.gravity = 20.0;
    scene.settings.gravity_direction = Vec3::new(0.1, -1.0, 0.1).normalize();
    let material = soft(&mut scene, "soft");
    let properties = Pair::default().restitution(0.3).friction(0.5).stiffness(1e3);
    scene.set_pair(material, material, properties).expect("a valid pair");
    scene.add_sphere(ball(&scene, material, [40.0, 0.0, 0.0], 0.5)).expect("a valid sphere");
    for k in 0..12_u8 {
        let (row, place) = (f32::from(k % 4), f32::from(k / 4));
        let position = [-0.55 * place - 0.03 * row, RADIUS, 0.46 * row];
        let moving = ball(&scene, material, position, RADIUS).velocity([3.0 + 0.2 * place, 0.0, 0.0]);
        scene.add_sphere(moving.angular_momentum([0.0, 0.0, -0.01])).expect("a valid sphere");
    }
    if with_rod {
        let capsule = Capsule::new([-0.4, 0.199, -0.6], [0.1, 0.199, -0.5], 0.2).density(1.0).velocity([3.0, 0.0, 0.0]);
        scene.add_capsule(capsule.material(material)).expect("a valid capsule");
    }
    let plate = Cuboid::between([-5.0, -1.0, -5.0], [20.0, 0.0, -0.35]);
    scene.add_box(plate.material(material)).expect("a valid box");
    for (row, (k, angle)) in (0..4_u8).flat_map(|row| (0..).zip(ANGLES).map(move |strip| (row, strip))) {
        let x = if k < 3 { -5.0 } else { 0.1 * k as f32 };
        let begin = Vec3::new(x, RADIUS, 0.46 * f32::from(row));
        scene.add_box(strip(begin, 20.0, RADIUS - 2e-4, angle).material(material)).expect("a valid box");
    }
    scene
}

fn opened(scene: &Scene, backend: Backend, method: BroadPhase, integrator: Integrator) -> Simulation {
    let options = options(backend).broad_phase(method).integrator(integrator);
    Simulation::with_options(scene.clone(), options).expect("the simulation opens")
}

/// Blocks of the pool of springs.
fn pool(simulation: &Simulation) -> u32 {
    #[cfg(feature = "gpu")]
    if let Some(world) = simulation.gpu_view() {
        return world.step().layout.history_pool;
    }
    simulation.cpu_view().expect("the CPU backend").step.layout.history_pool
}

/// The largest number of contacts that a ball has with boxes. It owns them all.
fn most_owned(simulation: &mut Simulation) -> usize {
    let contacts = simulation.contacts().expect("contacts");
    let mut counts = std::collections::HashMap::new();
    for contact in contacts.iter().filter(|contact| matches!(contact.b, rockfall::Body::Box(_))) {
        *counts.entry(contact.a).or_insert(0_usize) += 1;
    }
    counts.into_values().max().unwrap_or_default()
}

/// Runs a quarter of the steps at a time. `between` is called after each. After three quarters, the first ball is removed.
fn run(simulation: &mut Simulation, steps: u64, dt: f32, mut between: impl FnMut(&mut Simulation, u64)) -> Vec<u32> {
    for part in 0..4 {
        simulation.run(steps / 4, dt).expect("steps");
        between(simulation, part);
        if part == 2 {
            let first = simulation.scene().sphere_ids().next().expect("a ball");
            simulation.remove_sphere(first).expect("removed");
        }
    }
    bits_of(simulation)
}

fn chains_are_kept_bit_for_bit(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (2400_u64, 2.5e-4), (480, 1.25e-3));
    let (euler, verlet) = (Integrator::SymplecticEuler, Integrator::VelocityVerlet);
    for (law, integrator, with_rod) in [(ContactLaw::Linear, euler, true), (ContactLaw::HertzMindlin, verlet, false)] {
        let scene = troughs(law, with_rod);
        let mut whole = opened(&scene, backend, BroadPhase::Grid, integrator);
        let (mut owned, mut pools) = (vec![most_owned(&mut whole)], vec![pool(&whole)]);
        let expected = run(&mut whole, steps, dt, |_, _| {});
        let mut other = opened(&scene, backend, BroadPhase::BruteForce, integrator);
        let found = run(&mut other, steps, dt, |simulation, _| {
            owned.push(most_owned(simulation));
            pools.push(pool(simulation));
        });
        assert!(found == expected, "{law}, {integrator}, brute force");
        // One block, two and more. The pool grows in the middle.
        assert!(
            owned[0] <= 4 && owned.iter().any(|count| (5..=7).contains(count)) && owned.iter().any(|count| *count > 10),
            "{owned:?}"
        );
        assert!(pools[0] == 0 && pools.windows(2).filter(|pools| pools[0] < pools[1]).count() > 1, "{pools:?}");

        let mut parts = opened(&scene, backend, BroadPhase::Grid, integrator);
        let found = run(&mut parts, steps, dt, |simulation, part| match part {
            0 => simulation.sort_memory().expect("sorted memory"),
            1 => {
                let sticking = |contact: &rockfall::Contact| contact.springs.is_some_and(|springs| !springs.slips);
                let count = simulation.contacts().expect("contacts").iter().filter(|contact| sticking(contact)).count();
                assert!(count > 5, "{count} contacts stick");
                let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
                *simulation = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("valid")).expect("resumed");
            }
            2 => {
                let checkpoint = simulation.checkpoint().expect("a checkpoint");
                simulation.run(7, dt).expect("steps");
                simulation.restore(&checkpoint).expect("restored");
            }
            _ => {}
        });
        assert!(found == expected, "{law}, {integrator}, in parts");
    }
}

/// The pool has a quarter more blocks than the springs take, although the steps that follow a rejected one are on their way already
/// and evaluate the same contacts. A step without room is rejected once. Strips on both sides of a trough give a ball
/// springs that are mirror images, also those whose records are not in its own block.
fn the_pool_grows_once_to_a_quarter_more(backend: Backend) {
    let mut scene = scene_with(ContactLaw::Linear);
    scene.settings.precision = rockfall::Precision::Single;
    scene.settings.gravity = 10.0;
    let material = soft(&mut scene, "soft");
    pair(&mut scene, material, material, 0.3, 0.5);
    for k in 0..40_u8 {
        let [x, z] = [k % 8, k / 8].map(|k| 1.2 * f32::from(k));
        let moving = ball(&scene, material, [x, 0.499998, z], 0.5).velocity([0.001, -0.05, 0.0]);
        scene.add_sphere(moving).expect("a valid sphere");
    }
    for (row, k) in (0..5_u8).flat_map(|row| (0..12_u8).map(move |k| (row, k))) {
        let begin = Vec3::new(-5.0, 0.499998, 1.2 * f32::from(row));
        let strip = strip(begin, 20.0, 0.499998, 0.08 * (f32::from(k) - 5.5));
        scene.add_box(strip.material(material)).expect("a valid box");
    }
    let mut simulation = opened(&scene, backend, BroadPhase::Grid, Integrator::SymplecticEuler);
    let report = simulation.run(12, 1e-4).expect("steps");
    assert!(report.contacts == 12 * 40 && report.replays == 1, "{report:?}");
    // Balls with 12 records have a block with 3 of them and further ones with 3, 3 and 3.
    let needed = 40 * 3;
    assert_eq!(pool(&simulation), needed + needed / 4);
    let displacements: Vec<Vec3> =
        simulation.contacts().expect("contacts").iter().map(|contact| contact.springs.expect("springs").displacement).collect();
    // The strips are symmetric, and the records of the first ones are in the ball's own block.
    for of_ball in displacements.chunks_exact(12) {
        let mirrored = of_ball.iter().rev().map(|other| *other * Vec3::new(1.0, 1.0, -1.0));
        let are_alike = of_ball.iter().zip(mirrored).all(|(one, other)| one.distance(other) < 2e-3 * one.length());
        assert!(of_ball[0].x.abs() > 1e-7 && are_alike, "{of_ball:?}");
    }
}

both!(chains_are_kept_bit_for_bit, the_pool_grows_once_to_a_quarter_more);
