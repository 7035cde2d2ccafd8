//! Tests of `Writer`: trajectories that are written, resumed and refused.

use std::path::Path;

use rockfall::output::Mark;
use rockfall::{Backend, Error, Integrator, Options, Scene, Simulation, Sphere};
use rockfall_trajectory::{Format, Writer};

/// Simulation of two balls without gravity, one of which moves.
fn simulation() -> Simulation {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    for (x, speed) in [(0.0, 0.5), (5.0, 0.0)] {
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], 1.0).velocity([0.0, speed, 0.0])).expect("a valid sphere");
    }
    // Symplectic Euler, because its positions are exact here: it has no divisions.
    let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler);
    Simulation::with_options(scene, options).expect("it opens")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn the_extension_selects_the_format() {
    for (name, format) in [("a.npz", Format::Npz), ("a.VTP", Format::Vtp), ("a.pvd", Format::Vtp), ("a.Csv", Format::Csv)] {
        assert_eq!(Format::of(Path::new(name)), Some(format), "{name}");
    }
    for name in ["a", "a.vtu", "npz", "a.npz.gz", ".csv"] {
        assert_eq!(Format::of(Path::new(name)), None, "{name}");
    }
}

/// Uniform motion: y is half the time, and all numbers are exact.
#[test]
fn csv_lines_hold_the_states() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.csv");
    let mut simulation = simulation();
    let mut writer = Writer::create(&path, Format::Csv).expect("it is begun");
    writer.frame(&mut simulation).expect("a frame");
    simulation.run(2, 0.25).expect("steps");
    writer.frame(&mut simulation).expect("a frame");
    assert!(!path.exists(), "the file must not exist before it is complete");
    writer.finish(simulation.scene()).expect("it is finished");
    assert_eq!(
        std::fs::read_to_string(&path).expect("a file"),
        "step,time,sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz,reference\n\
         0,0,0,0,0,0,0,0.5,0,1,0,0,0,0,0,0,\n0,0,1,5,0,0,0,0,0,1,0,0,0,0,0,0,\n\
         2,0.5,0,0,0.25,0,0,0.5,0,1,0,0,0,0,0,0,\n2,0.5,1,5,0,0,0,0,0,1,0,0,0,0,0,0,\n"
    );
    assert_eq!(names(folder.path()), ["run.csv"]);
}

#[test]
fn an_unfinished_trajectory_is_removed_unless_it_was_marked() {
    let folder = tempfile::tempdir().expect("a folder");
    for format in [Format::Csv, Format::Npz] {
        let mut simulation = simulation();
        let mut writer = Writer::create(folder.path().join("run"), format).expect("it is begun");
        writer.frame(&mut simulation).expect("a frame");
        drop(writer);
        assert!(names(folder.path()).is_empty());
    }
    let path = folder.path().join("run.npz");
    let mut writer = Writer::create(&path, Format::Npz).expect("it is begun");
    writer.frame(&mut simulation()).expect("a frame");
    let mark = writer.mark().expect("it is marked").expect("a regular file");
    drop(writer);
    assert_eq!(names(folder.path()), [".run.npz.frames.part"]);
    Writer::resume(&path, Format::Npz, mark).expect("it is resumed").finish(simulation().scene()).expect("it is finished");
    assert_eq!(names(folder.path()), ["run.npz"]);
}

#[test]
fn resume_refuses_other_contents() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.npz");
    let mut writer = Writer::create(&path, Format::Npz).expect("it is begun");
    writer.frame(&mut simulation()).expect("a frame");
    writer.finish(simulation().scene()).expect("it is finished");
    // A head, the states, and which spheres they are.
    let frame = 32 + 2 * (56 + 21);
    for mark in [Mark { bytes: frame, crc32: 1 }, Mark { bytes: 2 * frame, crc32: 0 }, Mark { bytes: 7, crc32: 0 }] {
        let error = Writer::resume(&path, Format::Npz, mark).expect_err("another trajectory");
        assert!(matches!(error, Error::File { .. }) && error.to_string().contains("before"), "{error}");
        assert_eq!(names(folder.path()), ["run.npz"], "no other files are left");
    }
    std::fs::write(&path, "no archive").expect("a file");
    assert!(Writer::resume(&path, Format::Npz, Mark { bytes: frame, crc32: 1 }).is_err());
}
