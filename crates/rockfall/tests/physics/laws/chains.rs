//! Bodies that own more contacts than a block of springs holds (docs/buffers.md). Which blocks of the pool they take, and when the
//! pool grows, has no effect on results.

use rockfall::{Backend, BroadPhase, Capsule, Checkpoint, ContactLaw, Cuboid, Integrator, Pair, Scene, Simulation, glam::Vec3};

use super::{ball, options, pair, scene_with, soft};
use crate::common::bits_of;

/// Number of plates.
const PLATES: u8 = 14;

/// Balls and a capsule that roll over plates. All plates have the same top, and each begins a little further on than the one before,
/// so that a ball in motion touches more and more of them: from 1 up to 14. The first ball lies apart.
fn plates(law: ContactLaw, with_rod: bool) -> Scene {
    let mut scene = scene_with(law);
    scene.settings.gravity = 20.0;
    scene.settings.gravity_direction = Vec3::new(0.1, -1.0, 0.1).normalize();
    let material = soft(&mut scene, "soft");
    let properties = Pair::default().restitution(0.3).friction(0.5).stiffness(1e3);
    scene.set_pair(material, material, properties).expect("a valid pair");
    scene.add_sphere(ball(&scene, material, [40.0, 0.0, 0.0], 0.5)).expect("a valid sphere");
    for k in 0..12_u8 {
        let (row, place) = (f32::from(k % 4), f32::from(k / 4));
        let radius = if k % 3 == 0 { 0.2 } else { 0.25 };
        let position = [-0.55 * place - 0.03 * row, radius - 2e-4, 0.46 * row];
        let moving = ball(&scene, material, position, radius).velocity([3.0 + 0.2 * place, 0.0, 0.1 * (1.5 - row)]);
        scene.add_sphere(moving.angular_momentum([0.0, 0.0, -0.01])).expect("a valid sphere");
    }
    if with_rod {
        let capsule = Capsule::new([-0.4, 0.199, -0.6], [0.1, 0.199, -0.5], 0.2).density(1.0).velocity([3.0, 0.0, 0.0]);
        scene.add_capsule(capsule.material(material)).expect("a valid capsule");
    }
    for k in 0..PLATES {
        let low = [if k == 0 { -5.0 } else { 0.1 * f32::from(k) }, -1.0, -5.0 - f32::from(k)];
        scene.add_box(Cuboid::between(low, [20.0, 0.0, 5.0]).material(material)).expect("a valid box");
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
        return world.step().history_pool;
    }
    simulation.cpu_view().expect("the CPU backend").step.history_pool
}

/// The largest number of contacts that a ball has with plates. It owns them all.
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
        let scene = plates(law, with_rod);
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
                assert!(count > 15, "{count} contacts stick");
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
/// and evaluate the same contacts. A step without room is rejected once. Plates of the same height give a ball equal springs, also
/// those whose records are not in its own block.
fn the_pool_grows_once_to_a_quarter_more(backend: Backend) {
    let mut scene = scene_with(ContactLaw::Linear);
    scene.settings.precision = rockfall::Precision::Single;
    let material = soft(&mut scene, "soft");
    pair(&mut scene, material, material, 0.3, 0.5);
    for k in 0..40_u8 {
        let [x, z] = [k % 8, k / 8].map(|k| 1.2 * f32::from(k));
        let moving = ball(&scene, material, [x, 0.4999, z], 0.5).velocity([0.02, 0.0, 0.0]);
        scene.add_sphere(moving).expect("a valid sphere");
    }
    for k in 0..12_u8 {
        let low = Vec3::new(-5.0, -1.0, -5.0) - f32::from(k);
        scene.add_box(Cuboid::between(low.to_array(), [20.0, 0.0, 20.0]).material(material)).expect("a valid box");
    }
    let mut simulation = opened(&scene, backend, BroadPhase::Grid, Integrator::SymplecticEuler);
    let report = simulation.run(12, 1e-4).expect("steps");
    assert!(report.contacts == 12 * 40 && report.replays == 1, "{report:?}");
    // Balls with 12 records have a block with 3 of them and further ones with 3, 3 and 3.
    let needed = 40 * 3;
    assert_eq!(pool(&simulation), needed + needed / 4);
    let displacements: Vec<Vec3> =
        simulation.contacts().expect("contacts").iter().map(|contact| contact.springs.expect("springs").displacement).collect();
    for of_ball in displacements.chunks_exact(12) {
        assert!(of_ball[0].x.abs() > 1e-7 && of_ball.iter().all(|other| other.distance(of_ball[0]) < 1e-12), "{of_ball:?}");
    }
}

both!(chains_are_kept_bit_for_bit, the_pool_grows_once_to_a_quarter_more);
