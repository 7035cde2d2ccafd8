//! Tests of `Reader`: trajectories that are read back, and files that are refused.

use std::fs;
use std::path::{Path, PathBuf};

use rockfall::glam::{Quat, Vec3};
use rockfall::{Backend, Capsule, Cuboid, Options, Scene, Simulation, Sphere, SphereState, Spring};
use rockfall_trajectory::{Format, Reader, Writer};

fn on_cpu(scene: Scene) -> Simulation {
    Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens")
}

/// Objects of several kinds, with what no array of a trajectory holds: a capsule, a rest length, a group, a setting.
fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.settings.restitution = 0.25;
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).group(3)).expect("a box");
    let turned = Sphere::new([0.0, 2.0, 0.0], 0.5).orientation(Quat::from_rotation_y(0.3)).angular_momentum([0.1, 0.2, 0.3]);
    let a = scene.add_sphere(turned).expect("a sphere");
    let b = scene.add_sphere(Sphere::new([2.0, 3.0, 0.0], 0.3).velocity([0.5, 0.0, 0.0])).expect("a sphere");
    scene.add_spring(Spring::new(a, b, 5.0, 2.0)).expect("a spring");
    scene.add_capsule(Capsule::new([-2.0, 1.0, 0.0], [-3.0, 1.5, 0.5], 0.25)).expect("a capsule");
    scene
}

/// Writes frames after 0, 3, 6 and 9 steps of 0.01 s, and returns their states, with the positions as f32 that a trajectory holds.
fn write(path: &Path, format: Format) -> Vec<Vec<SphereState>> {
    let mut simulation = on_cpu(scene());
    let mut writer = Writer::create(path, format).expect("it is begun");
    let mut states = Vec::new();
    for frame in 0..4 {
        if frame > 0 {
            simulation.run(3, 0.01).expect("steps");
        }
        writer.frame(&mut simulation).expect("a frame");
        let rounded = |mut state: SphereState| {
            state.position_low = Vec3::ZERO;
            state
        };
        states.push(simulation.spheres().expect("states").into_iter().map(rounded).collect());
    }
    writer.finish(simulation.scene()).expect("it is finished");
    states
}

#[test]
fn frames_are_read_back_bitwise_identical() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, format) in [("run.npz", Format::Npz), ("run.pvd", Format::Vtp)] {
        let path = folder.path().join(name);
        let written = write(&path, format);
        let mut reader = Reader::open(&path).expect("it is read");
        let steps: Vec<u64> = reader.moments().iter().map(|moment| moment.step).collect();
        assert_eq!(steps, [0, 3, 6, 9]);
        assert!((reader.moments()[3].time - 0.09).abs() < 1e-6);
        assert_eq!(reader.scene().counts(), scene().counts());
        assert_eq!(reader.scene().settings.restitution, 0.25);
        assert_eq!(reader.scene().springs()[0].length, 2.0);
        let mut simulation = on_cpu(reader.scene().clone());
        // Out of order, because a program may go back.
        for frame in [2, 0, 3, 1] {
            reader.frame(frame).expect("a frame").apply(&mut simulation).expect("it fits");
            assert_eq!(simulation.spheres().expect("states"), written[frame], "{name} {frame}");
        }
        let error = reader.frame(4).unwrap_err().to_string();
        assert!(error.contains("4 frames"), "{error}");
    }
}

/// Changes a file, and returns the error of reading the trajectory at `path`, of opening it or of its last frame.
fn damaged(path: &Path, file: &Path, change: impl Fn(&mut Vec<u8>)) -> String {
    let sound = fs::read(file).expect("a file");
    let mut bytes = sound.clone();
    change(&mut bytes);
    fs::write(file, bytes).expect("it is written");
    let opened = Reader::open(path).and_then(|mut reader| reader.frame(3));
    fs::write(file, sound).expect("it is written");
    let error = opened.expect_err("it is damaged").to_string();
    assert!(error.starts_with(&path.display().to_string()), "{error}");
    error
}

fn find(bytes: &[u8], text: &str) -> usize {
    bytes.windows(text.len()).position(|window| window == text.as_bytes()).expect("it occurs")
}

#[test]
fn damaged_archives_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.npz");
    write(&path, Format::Npz);
    for (what, message) in [(0, ".npz"), (10, "complete"), (200, "complete")] {
        let error = damaged(&path, &path, |bytes| bytes.truncate(what));
        assert!(error.contains(message), "{what}: {error}");
    }
    // A bit of the position of a body.
    let error = damaged(&path, &path, |bytes| {
        let at = find(bytes, "position.npy") + 12 + 128 + 5;
        bytes[at] ^= 1;
    });
    assert!(error.contains("array position"), "{error}");
    let error = damaged(&path, &path, |bytes| {
        // Names occur at the entry and in the directory at the end.
        for _ in 0..2 {
            let at = find(bytes, "velocity.npy");
            bytes[at] = b'V';
        }
    });
    assert!(error.contains("no array velocity"), "{error}");
    fs::write(&path, "S 1 0 0 0 0 0 0 0 0 0 1 1\n").expect("it is written");
    assert!(Reader::open(&path).unwrap_err().to_string().contains(".npz"));
}

#[test]
fn damaged_series_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.pvd");
    write(&path, Format::Vtp);
    let file = |name: &str| -> PathBuf { folder.path().join("run").join(name) };
    let cut = |length: usize| move |bytes: &mut Vec<u8>| bytes.truncate(length);
    assert!(damaged(&path, &path, cut(100)).contains("not a complete .pvd list"));
    assert!(damaged(&path, &file("scene.txt"), |bytes| bytes.truncate(0)).contains("has 4 spheres, but its scene has 0"));
    let last = file("0000000009.vtp");
    let length = fs::metadata(&last).expect("a file").len() as usize;
    assert!(damaged(&path, &last, cut(length - 600)).contains("cut off"));
    assert!(damaged(&path, &last, cut(300)).contains("cut off"));
    let error = damaged(&path, &last, |bytes| {
        let at = find(bytes, "\"velocity\"") + 1;
        bytes[at] = b'V';
    });
    assert!(error.contains("no array velocity"), "{error}");
    fs::remove_file(file("0000000006.vtp")).expect("it is removed");
    let error = Reader::open(&path).unwrap_err().to_string();
    assert!(error.contains("0000000006.vtp does not exist"), "{error}");
    fs::remove_file(file("scene.txt")).expect("it is removed");
    fs::write(file("0000000006.vtp"), "").expect("it is written");
    let error = Reader::open(&path).unwrap_err().to_string();
    assert!(error.contains("scene.txt"), "{error}");
}

#[test]
fn states_of_another_scene_do_not_fit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.npz");
    write(&path, Format::Npz);
    let mut simulation = on_cpu(Scene::new());
    let error = Reader::open(&path).and_then(|mut reader| reader.frame(0)?.apply(&mut simulation)).unwrap_err();
    assert!(error.to_string().contains("4 spheres"), "{error}");
}
