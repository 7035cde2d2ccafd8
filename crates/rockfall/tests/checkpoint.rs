//! A run that was interrupted and resumed ends in the same bits as one that was not, and no damaged file is taken for a
//! checkpoint.

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, BroadPhase, Checkpoint, Error, Integrator, Options, Scene, Simulation, Sphere, SphereId};

#[macro_use]
mod common;

use common::mixed::{Run, mixed, same_bits};
use common::*;

const DT: f32 = 0.01;

/// Through the bytes of a file, as another process would do it.
fn resumed(simulation: &mut Simulation) -> Simulation {
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("a good one")).expect("the simulation opens")
}

/// With gravity and balls thrown about, so that lists, margins and rod lengths have a history when the checkpoint is taken:
/// from the first step to the middle of collisions.
fn a_resumed_run_ends_in_the_same_bits(backend: Backend) {
    let (steps, stops) = on(backend, (120, vec![0, 1, 37, 60, 61, 100]), (24, vec![9, 14]));
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        for method in [BroadPhase::BruteForce, BroadPhase::SortAndSkip, BroadPhase::Grid] {
            let options = Options::new().backend(backend).integrator(integrator).broad_phase(method);
            let start = || Simulation::with_options(mixed(80), options.clone()).expect("the simulation opens");
            let mut whole = start();
            whole.run(steps, DT).expect("steps");
            let whole = Run::of(&mut whole);
            assert!(whole.report.total_collisions > 10, "{:?}", whole.report);
            let mut interrupted = start();
            for stop in &stops {
                interrupted.run(stop - interrupted.report().steps, DT).expect("steps");
                let mut resumed = resumed(&mut interrupted);
                assert_eq!(resumed.report(), interrupted.report());
                assert_eq!(resumed.time_step().to_bits(), interrupted.time_step().to_bits());
                resumed.run(steps - stop, DT).expect("steps");
                same_bits(&whole, &Run::of(&mut resumed));
            }
            // Checkpoints that were taken of it did not change its course either.
            interrupted.run(steps - interrupted.report().steps, DT).expect("steps");
            same_bits(&whole, &Run::of(&mut interrupted));
        }
    }
}

/// What edits leave behind: gaps in the handles, outside forces, groups, settings of one's own.
fn what_edits_left_is_kept(backend: Backend) {
    let mut scene = mixed(40);
    let thrown = scene.add_sphere(Sphere::new([0.2, 3.0, 0.1], 0.2).group(7)).expect("a valid sphere");
    let mut simulation = simulation(scene, backend);
    simulation.run(10, DT).expect("steps");
    let first: Vec<SphereId> = simulation.scene().sphere_ids().take(6).collect();
    simulation.remove_sphere(first[2]).expect("a ball to remove");
    simulation.add_sphere(Sphere::new([0.0, 4.0, 0.0], 0.25).velocity([0.0, -4.0, 0.0])).expect("a valid sphere");
    simulation.set_force(first[4], [0.0, 30.0, 0.0]).expect("a ball to lift");
    simulation.set_orientation(first[5], Quat::from_rotation_x(1.0)).expect("a ball to turn");
    let mut settings = *simulation.settings();
    settings.gravity_direction = Vec3::new(0.0, -3.0, 0.5);
    settings.restitution = 0.3;
    settings.contact_pull = true;
    simulation.set_settings(settings).expect("valid settings");

    // Edits that have not reached the device yet are part of it.
    simulation.set_velocity(first[3], [1.0, 2.0, 0.0]).expect("a ball to throw");
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    let from_file = Checkpoint::from_bytes(&checkpoint.to_bytes(), "memory").expect("a good one");
    assert_eq!(from_file.scene.settings, settings);
    assert_eq!(from_file.scene.spheres(), checkpoint.scene.spheres());
    assert_eq!(from_file.scene.counts(), checkpoint.scene.counts());
    assert_eq!(from_file.to_bytes(), checkpoint.to_bytes());

    let mut from_file = Simulation::resume(from_file).expect("the simulation opens");
    let mut in_memory = Simulation::resume(checkpoint).expect("the simulation opens");
    assert!(from_file.sphere(thrown).is_err(), "a handle of another scene");
    assert!(in_memory.sphere(thrown).is_ok() && in_memory.sphere(first[2]).is_err(), "handles of the same scene");
    for simulation in [&mut simulation, &mut from_file, &mut in_memory] {
        simulation.run(on(backend, 60, 10), DT).expect("steps");
    }
    let end = Run::of(&mut simulation);
    same_bits(&end, &Run::of(&mut from_file));
    same_bits(&end, &Run::of(&mut in_memory));
}

/// The forces of a step know which contacts collided in it; that is nowhere but in its lists.
fn within_a_step_there_is_no_checkpoint(backend: Backend) {
    let mut scene = weightless();
    let balls = [Sphere::new([0.0; 3], 0.5).velocity([1.0, 0.0, 0.0]), Sphere::new([0.9, 0.0, 0.0], 0.5)];
    spheres(&mut scene, balls);
    let mut simulation = simulation(scene, backend);
    simulation.handle_collisions().expect("a phase");
    let error = simulation.checkpoint().expect_err("within a step");
    assert!(error.to_string().contains("between two steps"), "{error}");
    simulation.update_positions(DT).expect("a phase");
    let mut resumed = resumed(&mut simulation);
    for simulation in [&mut simulation, &mut resumed] {
        simulation.run(5, DT).expect("steps");
    }
    same_bits(&Run::of(&mut simulation), &Run::of(&mut resumed));
}

both!(a_resumed_run_ends_in_the_same_bits, what_edits_left_is_kept, within_a_step_there_is_no_checkpoint);

/// A small checkpoint with something of every kind.
fn small() -> Vec<u8> {
    let mut simulation = Simulation::with_options(mixed(2), Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(3, DT).expect("steps");
    let mut checkpoint = simulation.checkpoint().expect("a checkpoint");
    checkpoint.note = "kept for the caller: \u{3c0}".to_owned();
    checkpoint.to_bytes()
}

#[track_caller]
fn refused(bytes: &[u8]) -> String {
    match Checkpoint::from_bytes(bytes, "file.ckpt") {
        Err(error @ Error::Checkpoint { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn notes_and_options_come_back() {
    let checkpoint = Checkpoint::from_bytes(&small(), "file.ckpt").expect("a good one");
    assert_eq!(checkpoint.note, "kept for the caller: \u{3c0}");
    assert_eq!(checkpoint.options.backend, Backend::Cpu);
    assert_eq!((checkpoint.report.steps, checkpoint.time_step), (3, DT));
    assert_eq!(checkpoint.to_bytes(), small(), "the same state makes the same bytes");
}

#[test]
fn whatever_is_cut_off_or_changed_is_refused() {
    let good = small();
    for length in 0..good.len() {
        refused(&good[..length]);
    }
    for place in 0..good.len() {
        for flip in [1, 0x80, 0xff] {
            let mut bad = good.clone();
            bad[place] ^= flip;
            refused(&bad);
        }
    }
    let longer = [good.as_slice(), &[0]].concat();
    assert!(refused(&longer).contains(&format!("it has {} bytes, expected {}", longer.len(), good.len())));
}

#[test]
fn reasons_are_told() {
    let good = small();
    assert_eq!(refused(&[]), "file.ckpt: not a usable checkpoint: it is empty");
    assert!(refused(b"S 1 0 0 0 0 0 0 0 0 0 1 1\n").contains("does not begin as a checkpoint"));
    assert!(refused(&good[..good.len() / 2]).contains("bytes, expected"));
    let mut bad = good.clone();
    bad[100] ^= 4;
    assert!(refused(&bad).contains("checksum"));
    let mut newer = good;
    newer[8] = 2;
    assert!(refused(&newer).contains("it has version 2, this rockfall reads version 1"));
}

/// A file that was made to look good: checksums keep out accidents, not nonsense. Every word of it is replaced by what
/// numbers should not be; it is refused, or another good one, but nothing panics and nothing takes all memory.
#[test]
fn nonsense_with_a_good_checksum_is_no_panic() {
    let good = small();
    let (mut taken, mut refused) = (0, 0);
    for place in 20..good.len() - 8 {
        for nonsense in [0, 1, u32::MAX, f32::NAN.to_bits(), f32::INFINITY.to_bits(), 0x8000_0000, 0x7fff_ffff] {
            let mut bad = good.clone();
            bad[place..place + 4].copy_from_slice(&nonsense.to_le_bytes());
            let end = bad.len() - 4;
            let crc32 = crc32fast::hash(&bad[..end]);
            bad[end..].copy_from_slice(&crc32.to_le_bytes());
            match Checkpoint::from_bytes(&bad, "file.ckpt") {
                Ok(_) => taken += 1,
                Err(_) => refused += 1,
            }
        }
    }
    assert!(taken > 100 && refused > 100, "{taken} taken, {refused} refused");
}

#[test]
fn an_empty_scene_has_a_checkpoint_too() {
    let mut simulation = Simulation::with_options(Scene::new(), Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(2, DT).expect("steps");
    assert_eq!(resumed(&mut simulation).run(3, DT).expect("steps").steps, 5);
}

#[test]
fn a_file_is_read_back_and_what_is_none_is_named() {
    let folder = std::env::temp_dir().join(format!("rockfall-checkpoint-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("a.ckpt");
    let checkpoint = Checkpoint::from_bytes(&small(), "memory").expect("a good one");
    checkpoint.save(&path).expect("it is written");
    assert_eq!(std::fs::read(&path).expect("a file"), small());
    assert_eq!(Checkpoint::load(&path).expect("a good one").to_bytes(), small());
    assert!(Checkpoint::load(&folder).expect_err("a folder").to_string().contains("rockfall-checkpoint-"));
    assert!(matches!(Checkpoint::load(folder.join("none.ckpt")), Err(Error::File { .. })));
    assert!(matches!(checkpoint.save(folder.join("no/a.ckpt")), Err(Error::File { .. })));
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}
