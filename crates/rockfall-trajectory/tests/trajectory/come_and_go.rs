//! Tests of trajectories in which spheres come and go.

use std::fs;
use std::path::{Path, PathBuf};

use rockfall::glam::{Quat, Vec3};
use rockfall::output::Mark;
use rockfall::{
    Backend, Capsule, Colour, Cuboid, Inlet, Options, Outlet, Rate, Scene, Shape, Simulation, Sphere, SphereId, Tag,
};
use rockfall_trajectory::{Format, Reader, Writer};

const RED: Colour = Colour([255, 0, 0]);

fn on_cpu(scene: Scene) -> Simulation {
    Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens")
}

/// A red stream, two equal capsules of which the lower one leaves first, and a sphere that stays.
fn stream() -> Scene {
    let mut scene = Scene::new();
    scene.settings.gravity = 9.81;
    let mut red = Tag::new();
    red.colour = Some(RED);
    let feed = Inlet::new("feed", [[0.0, 2.0, 0.0], [3.0, 3.0, 3.0]], Rate::Number(100.0), 0.1).every(1).tag(red);
    scene.add_inlet(feed).expect("an inlet");
    scene.add_outlet(Outlet::new("drain", [[-9.0, -9.0, -9.0], [9.0, 0.0, 9.0]]).every(1)).expect("an outlet");
    for y in [1.0, 0.25] {
        scene.add_capsule(Capsule::new([-2.0, y, 0.0], [-3.0, y, 0.0], 0.1)).expect("a capsule");
    }
    scene.add_sphere(Sphere::new([6.0, 1.0, 0.0], 0.5)).expect("a sphere");
    scene.add_box(Cuboid::between([5.0, 0.0, -1.0], [7.0, 0.5, 1.0])).expect("a box");
    scene
}

/// The spheres of a frame: handle and position.
type Seen = Vec<(SphereId, Vec3)>;

fn seen(simulation: &mut Simulation) -> Seen {
    let states = simulation.spheres().expect("states");
    simulation.scene().sphere_ids().zip(states.iter().map(|state| state.position)).collect()
}

fn frame(writer: &mut Writer, simulation: &mut Simulation) -> Seen {
    writer.frame(simulation).expect("a frame");
    seen(simulation)
}

/// Writes frames after 0, 7, ... steps of 10 ms.
fn write(path: &Path, format: Format, frames: usize) -> Vec<Seen> {
    let mut simulation = on_cpu(stream());
    let mut writer = Writer::create(path, format).expect("it is begun");
    let mut written = vec![frame(&mut writer, &mut simulation)];
    for _ in 1..frames {
        simulation.run(7, 0.01).expect("steps");
        written.push(frame(&mut writer, &mut simulation));
    }
    writer.finish(simulation.scene()).expect("it is finished");
    written
}

fn file(folder: &tempfile::TempDir, name: &str) -> PathBuf {
    folder.path().join(name)
}

#[test]
fn frames_are_shown_with_their_spheres_in_any_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, "run.npz");
    let written = write(&path, Format::Npz, 16);
    let mut reader = Reader::open(&path).expect("it is read");
    assert!(!reader.is_constant());
    let everyone = reader.spheres();
    assert_eq!(everyone.len(), reader.scene().counts().spheres);
    // The same sphere has the same number in all frames, and different ones have different numbers.
    let mut handles = std::collections::HashMap::new();
    for (index, expected) in written.iter().enumerate() {
        let states = reader.frame(index).expect("a frame");
        assert_eq!(states.positions, expected.iter().map(|(_, position)| *position).collect::<Vec<_>>(), "{index}");
        for (id, (handle, _)) in states.ids.iter().zip(expected) {
            assert_eq!(handles.insert(*id, *handle).unwrap_or(*handle), *handle, "frame {index}, id {id}");
        }
    }
    assert_eq!(handles.len(), everyone.len());
    let mut simulation = on_cpu(reader.scene().clone());
    for index in [15, 3, 0, 9, 3, 14] {
        reader.show(index, &mut simulation).expect("it fits");
        let states = reader.frame(index).expect("a frame");
        let expected: Vec<_> =
            states.ids.iter().map(|id| everyone[*id as usize]).zip(states.positions.iter().copied()).collect();
        let mut shown = seen(&mut simulation);
        shown.sort_by_key(|(id, _)| expected.iter().position(|(other, _)| other == id));
        assert_eq!(shown, expected, "{index}");
        assert_eq!(simulation.scene().counts().boxes, 1);
    }
    // Spheres that have left look as those that the inlet lets in.
    reader.show(9, &mut simulation).expect("it fits");
    let gone = simulation.scene().sphere_ids().last().expect("a sphere");
    let tag = simulation.scene().tag(gone).expect("it is there").cloned().unwrap_or_default();
    assert_eq!(tag.colour, Some(RED));
}

/// Rigid bodies that have left are bodies again in the frames that have them.
#[test]
fn frames_are_shown_with_their_rigid_bodies() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, "run.npz");
    let mut scene = stream();
    let brick = Cuboid::between([-0.1, -0.05, -0.05], [0.1, 0.05, 0.05]);
    let shape = scene.add_shape(Shape::new().cuboid(brick).density(2.0)).expect("a shape");
    let inlet = Inlet::of_bodies("bricks", [[-9.0, 1.0, 0.0], [-5.0, 2.0, 3.0]], Rate::Number(60.0), shape);
    scene.add_inlet(inlet.every(1)).expect("an inlet");
    let mut simulation = on_cpu(scene);
    let mut writer = Writer::create(&path, Format::Npz).expect("it is begun");
    let mut written = Vec::new();
    for _ in 0..12 {
        writer.frame(&mut simulation).expect("a frame");
        simulation.sync().expect("a state");
        written.push(simulation.scene().bodies().iter().map(|body| (body.position, body.orientation)).collect::<Vec<_>>());
        simulation.run(7, 0.01).expect("steps");
    }
    writer.finish(simulation.scene()).expect("it is finished");
    assert!(simulation.flow().outlets[0].spheres > 15 && written[6].len() > 10, "{:?}", simulation.flow());

    let mut reader = Reader::open(&path).expect("it is read");
    let mut simulation = on_cpu(reader.scene().clone());
    for index in [11, 6, 2, 0, 9] {
        reader.show(index, &mut simulation).expect("it fits");
        let mut shown: Vec<_> = simulation.scene().bodies().iter().map(|body| (body.position, body.orientation)).collect();
        assert_eq!(shown.len(), written[index].len(), "{index}");
        for (position, orientation) in &written[index] {
            let near = |body: &(Vec3, Quat)| body.0.distance(*position) < 1e-5 && body.1.dot(*orientation).abs() > 1.0 - 1e-5;
            shown.remove(shown.iter().position(near).unwrap_or_else(|| panic!("{index}: no body at {position}")));
        }
    }
}

#[test]
fn a_simulation_with_other_spheres_does_not_fit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, "run.npz");
    write(&path, Format::Npz, 4);
    let mut reader = Reader::open(&path).expect("it is read");
    let mut simulation = on_cpu(reader.scene().clone());
    reader.show(1, &mut simulation).expect("it fits");
    simulation.add_sphere(Sphere::new([0.0, 9.0, 0.0], 1.0)).expect("a sphere");
    let error = reader.show(2, &mut simulation).expect_err("a sphere too many").to_string();
    assert!(error.contains("the spheres of a frame of the trajectory"), "{error}");
}

/// Equal capsules of which one leaves between the last frame and the mark are told apart, too.
#[test]
fn a_file_that_is_continued_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let [whole, parts] = ["whole.npz", "parts.npz"].map(|name| file(&folder, name));
    write(&whole, Format::Npz, 12);
    for is_finished in [false, true] {
        let mut simulation = on_cpu(stream());
        let mut writer = Writer::create(&parts, Format::Npz).expect("it is begun");
        let mut capsules = Vec::new();
        for step in (0..28).step_by(7) {
            frame(&mut writer, &mut simulation);
            capsules.push(simulation.scene().counts().capsules);
            simulation.run(if step == 21 { 5 } else { 7 }, 0.01).expect("steps");
        }
        let mark: Mark = writer.mark().expect("it is marked").expect("a regular file");
        assert_eq!((capsules[3], simulation.scene().counts().capsules), (2, 1), "a capsule has left since the last frame");
        let bytes = simulation.checkpoint().expect("a state").to_bytes();
        if is_finished {
            simulation.run(2, 0.01).expect("steps");
            frame(&mut writer, &mut simulation);
            writer.finish(simulation.scene()).expect("it is finished");
        } else {
            drop(writer);
        }
        let checkpoint = rockfall::Checkpoint::from_bytes(&bytes, "a.ckpt").expect("a checkpoint");
        let mut simulation = Simulation::resume(checkpoint).expect("it goes on");
        let mut writer = Writer::resume(&parts, Format::Npz, mark).expect("it is resumed");
        for frames in 4..12 {
            simulation.run(if frames == 4 { 2 } else { 7 }, 0.01).expect("steps");
            frame(&mut writer, &mut simulation);
        }
        writer.finish(simulation.scene()).expect("it is finished");
        assert!(fs::read(&whole).expect("bytes") == fs::read(&parts).expect("bytes"), "finished before: {is_finished}");
    }
}

/// A scene with an inlet whose spheres stay the same in the recording has the file of a scene without one.
#[test]
fn a_constant_number_gives_arrays_per_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, "run.npz");
    let mut scene = Scene::new();
    scene.add_inlet(Inlet::new("feed", [[0.0; 3], [3.0, 1.0, 3.0]], Rate::Number(0.01), 0.1)).expect("an inlet");
    scene.add_sphere(Sphere::new([6.0, 1.0, 0.0], 0.5)).expect("a sphere");
    let mut simulation = on_cpu(scene);
    let mut writer = Writer::create(&path, Format::Npz).expect("it is begun");
    for _ in 0..3 {
        frame(&mut writer, &mut simulation);
        simulation.run(2, 0.01).expect("steps");
    }
    writer.finish(simulation.scene()).expect("it is finished");
    let mut reader = Reader::open(&path).expect("it is read");
    assert!(reader.is_constant() && reader.frame(2).expect("a frame").ids == [0]);
    let bytes = fs::read(&path).expect("bytes");
    assert!(!bytes.windows(11).any(|window| window == b"offsets.npy"));
}

#[test]
fn other_files_are_read_back_or_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let [csv, pvd] = ["run.csv", "run.pvd"].map(|name| file(&folder, name));
    write(&csv, Format::Csv, 3);
    write(&pvd, Format::Vtp, 3);
    // References tell the spheres apart. Before step k, k spheres are due. The five other spheres have no reference.
    let text = fs::read_to_string(&csv).expect("text");
    let references = |step: &str| -> Vec<&str> {
        let lines = text.lines().filter(|line| line.starts_with(step));
        lines.filter_map(|line| line.rsplit(',').next()).filter(|reference| !reference.is_empty()).collect()
    };
    assert_eq!(references("7,").len(), 6);
    let error = Reader::open(&pvd).expect_err("other spheres in each frame").to_string();
    assert!(error.contains("its spheres come and go") && error.contains("expected an .npz file"), "{error}");
}

/// Offsets and ids that do not fit are refused.
#[test]
fn damaged_numbers_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, "run.npz");
    write(&path, Format::Npz, 4);
    let sound = fs::read(&path).expect("bytes");
    for name in ["offsets", "id", "scene_id"] {
        let mut bytes = sound.clone();
        let entry = format!("{name}.npy");
        let at = bytes.windows(entry.len()).position(|window| window == entry.as_bytes()).expect("it occurs");
        bytes[at + entry.len() + 128 + 3] ^= 1;
        fs::write(&path, bytes).expect("it is written");
        let error = Reader::open(&path).expect_err("it is damaged").to_string();
        assert!(error.contains(&format!("array {name}")), "{error}");
    }
}
