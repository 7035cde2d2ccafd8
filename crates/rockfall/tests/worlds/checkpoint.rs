//! Worlds go on from a file as if they had never stopped.

use std::path::{Path, PathBuf};

use rockfall::generate::{Kind, creature};
use rockfall::glam::Vec3;
use rockfall::{Backend, Error, Integrator, Options, Scene, Sphere, SphereState, Worlds};

const DT: f32 = 0.005;

/// The path of a file that does not exist.
fn file(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("worlds-{name}-{}.ckpt", std::process::id()));
    let _ = std::fs::remove_file(&path);
    path
}

fn worlds(scenes: &[Scene], backend: Backend, integrator: Integrator) -> Worlds {
    Worlds::new(scenes.to_vec(), Options::new().backend(backend).integrator(integrator)).expect("worlds")
}

/// Everything that a user sees of worlds.
fn seen(worlds: &mut Worlds) -> Vec<String> {
    let count = worlds.len();
    let describe = |world: usize| {
        let report = worlds.report(world, None).expect("a report");
        let states: Vec<SphereState> = worlds.states(world).expect("states");
        let springs: Vec<f32> = worlds.scene(world).expect("a scene").springs().iter().map(|spring| spring.length).collect();
        let report = (report.report.steps, report.report.time, report.path, report.stopped);
        format!("{report:?} {states:?} {springs:?}")
    };
    (0..count).map(describe).collect()
}

fn resumed_worlds_go_on(backend: Backend) {
    let path = file(&format!("resumed-{backend}"));
    let mut bad = creature(6, 3).expect("a creature");
    bad.add_sphere(Sphere::new([0.0, 9.0, 0.0], 0.1).mass(1e-30).force([1e30, 0.0, 0.0])).expect("a sphere");
    let mut scenes = vec![creature(12, 0).expect("a creature"), bad, creature(8, 1).expect("a creature")];
    if backend == Backend::Cpu {
        scenes.push(Kind::Chain.generate(7, 1).expect("a scene"));
    }
    let mut whole = worlds(&scenes, backend, Integrator::Rk4);
    whole.run(30, DT).expect("steps");
    let count = whole.scene(0).expect("a scene").springs().len();
    whole.set_rest_lengths(0, &vec![0.4; count]).expect("lengths");
    whole.set_forces(2, &[Vec3::X; 8]).expect("forces");
    whole.run(10, DT).expect("steps");
    whole.save_checkpoint(&path).expect("a file");
    let mut resumed = Worlds::resume(&path, None).expect("worlds");
    assert_eq!((resumed.options().backend, resumed.time_step()), (backend, DT));
    assert_eq!(seen(&mut resumed), seen(&mut whole));
    for both in [&mut whole, &mut resumed] {
        both.run(20, DT).expect("steps");
        both.reset(&[2]).expect("a reset");
        both.run(15, DT).expect("steps");
    }
    assert_eq!(seen(&mut resumed), seen(&mut whole));
    assert!(seen(&mut whole)[1].contains("stopped being finite") && seen(&mut whole)[2].starts_with("(15,"));
}

both_in_turn!(resumed_worlds_go_on);

#[test]
fn a_file_of_no_worlds_keeps_the_options() {
    let path = file("empty");
    worlds(&[], Backend::Cpu, Integrator::SymplecticEuler).save_checkpoint(&path).expect("a file");
    let resumed = Worlds::resume(&path, None).expect("worlds");
    assert!(resumed.is_empty());
    assert_eq!(resumed.options().integrator, Integrator::SymplecticEuler.into());
}

#[test]
fn damaged_files_are_refused() {
    let path = file("damaged");
    let missing = Worlds::resume(&path, None).expect_err("no file");
    assert!(matches!(missing, Error::File { .. }), "{missing}");
    let mut worlds = worlds(&[creature(6, 0).expect("a creature")], Backend::Cpu, Integrator::Rk4);
    worlds.save_checkpoint(&path).expect("a file");
    let bytes = std::fs::read(&path).expect("a file");
    // Every 11th byte changed, and every 11th length.
    for place in (0..bytes.len()).step_by(11) {
        let mut changed = bytes.clone();
        changed[place] ^= 0x40;
        for damaged in [&changed[..], &bytes[..place]] {
            std::fs::write(&path, damaged).expect("a file");
            let error = Worlds::resume(&path, None).expect_err("it is damaged");
            assert!(matches!(error, Error::Checkpoint { .. }), "{place}: {error}");
        }
    }
    // A checkpoint of a simulation is another kind of file.
    let mut simulation = rockfall::Simulation::with_options(Scene::new(), Options::new().backend(Backend::Cpu)).expect("one");
    simulation.save_checkpoint(&path).expect("a file");
    let error = Worlds::resume(&path, None).expect_err("another kind");
    assert!(error.to_string().contains("does not begin as"), "{error}");
    let folder = Worlds::resume(env!("CARGO_TARGET_TMPDIR"), None).expect_err("a folder");
    assert!(folder.to_string().contains("not a regular file"), "{folder}");
}
