//! Loading and saving of scenes.

use std::fs;
use std::path::{Path, PathBuf};

use rockfall::glam::Vec3;
use rockfall::{Scene, Sphere};
use rockfall_viewer::window::controls::Command;
use rockfall_viewer::window::dialog::Choice;
use rockfall_viewer::window::message::Level;
use rockfall_viewer::window::session::Session;

use crate::common::*;

/// Creates a folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

#[test]
fn a_bad_scene_gives_a_message_and_the_present_one_continues() {
    let folder = folder(&[("bad.txt", "B 0 0 0 1 0 0 0 1 0 0 0 1\nS 1 0 0 0 0 0 0 0 0 0 -1 0.5\n")]);
    let mut viewer = viewer(BALL);
    viewer.command(Command::ToggleRunning);
    viewer.session.frame(0.0, 0.0, |_| ());
    viewer.load(&folder.path().join("bad.txt"));
    let [text, ..] = messages(&viewer.session)[..] else { panic!("there is no message") };
    assert!(text.contains("bad.txt:2: ") && text.contains("mass"), "{text}");
    assert_eq!(viewer.session.messages.all()[0].level, Level::Error);
    assert!(viewer.session.running() && !viewer.session.device_failed());
    viewer.session.frame(0.1, 0.1, |_| ());
    assert_eq!(viewer.session.simulation().report().steps, 2);
    viewer.load(&folder.path().join("none.txt"));
    assert!(messages(&viewer.session)[0].contains("none.txt"));
}

#[test]
fn a_good_scene_replaces_the_present_one_and_is_framed() {
    let folder = folder(&[("far.txt", "S 1 1000 0 0 0 0 0 0 0 0 1 0.5\nX\nset gravit 3\n")]);
    let mut viewer = viewer(BALL);
    viewer.command(Command::SingleStep);
    let path = folder.path().join("far.txt");
    viewer.load(&path);
    assert_eq!(viewer.session.source().name, path.display().to_string());
    assert_eq!(viewer.session.simulation().report().steps, 0);
    assert!(viewer.camera.target.x > 900.0);
    assert!(messages(&viewer.session).iter().any(|text| text.contains("far.txt:3: ")), "there is no warning");
    // When the same file is loaded again, the camera stays.
    viewer.scroll(3.0);
    let camera = viewer.camera;
    viewer.load(&path);
    assert_eq!(viewer.camera, camera);
}

/// Key R: the working directory first, then the folder of the program.
#[test]
fn input_is_loaded_from_the_first_folder_that_contains_it() {
    let with = folder(&[("input.txt", FLOATING)]);
    let (without, other) = (folder(&[]), folder(&[("input.txt", BALL)]));
    let mut viewer = viewer(BALL);
    let paths = |folders: [&tempfile::TempDir; 2]| folders.map(|folder| folder.path().to_owned()).to_vec();
    viewer.input_folders = paths([&with, &other]);
    viewer.command(Command::LoadInput);
    assert_eq!(viewer.session.simulation().scene().counts().spheres, 2);
    viewer.input_folders = paths([&without, &other]);
    viewer.command(Command::LoadInput);
    assert_eq!(viewer.session.simulation().scene().counts().spheres, 1);
    viewer.input_folders = paths([&without, &without]);
    viewer.command(Command::LoadInput);
    assert!(messages(&viewer.session)[0].contains("there is no input.txt"), "{:?}", messages(&viewer.session));
    assert_eq!(viewer.session.simulation().scene().counts().spheres, 1);
}

/// Key Shift+R: the file of the command line with the constants of the command line, whatever was loaded since.
#[test]
fn the_file_of_the_command_line_is_loaded_again() {
    let folder = folder(&[("given.txt", BALL), ("other.txt", FLOATING)]);
    let given = folder.path().join("given.txt");
    let overrides = vec![("friction".to_owned(), "7".to_owned())];
    let mut session = Session::open(source(BALL, Some(given.clone())), overrides, 0.02, on_cpu()).expect("it opens");
    session.load(&folder.path().join("other.txt"));
    assert_eq!((session.settings().gravity, session.settings().friction), (0.0, 7.0));
    fs::write(&given, format!("{BALL}S 2 2 3 0 0 0 0 0 0 0 1 0.5\n")).expect("a file");
    session.load_given();
    assert_eq!(session.simulation().scene().counts().spheres, 2);
    assert_eq!((session.settings().gravity, session.settings().friction), (1.0, 7.0));

    let mut without = crate::common::session(BALL);
    without.load_given();
    assert!(messages(&without)[0].contains("no scene file was given"));
}

/// The spheres of a scene with single precision, whose text has positions as f32.
fn as_text(scene: &Scene) -> Vec<Sphere> {
    let rounded = |mut sphere: Sphere| {
        sphere.position_low = Vec3::ZERO;
        sphere
    };
    scene.spheres().iter().copied().map(rounded).collect()
}

/// The saved state is bitwise identical to the present one, without the tether of a held body.
#[test]
fn the_present_state_is_saved() {
    let folder = folder(&[]);
    let mut viewer = viewer(BALL);
    viewer.command(Command::Throw);
    viewer.command(Command::Nudge { constant: 3, up: true });
    for _ in 0..10 {
        viewer.command(Command::SingleStep);
    }
    let path = folder.path().join("saved.txt");
    let sight = crate::pointer::sight_of(&mut viewer.session, 0);
    viewer.session.hold(&sight);
    assert_eq!(viewer.session.simulation().scene().counts().tethers, 1);
    viewer.choose(&Choice::Save(path.clone()));
    let saved = Scene::load(&path).expect("it reads back").scene;
    assert_eq!(saved.counts().tethers, 0);
    assert_eq!(saved.spheres(), as_text(viewer.session.simulation().scene()));
    assert_eq!(saved.settings, *viewer.session.settings());
    // A file that cannot be written gives a message, and the dialog stays.
    viewer.command(Command::SaveAs);
    viewer.choose(&Choice::Save(PathBuf::from("/no/such/folder/saved.txt")));
    assert!(messages(&viewer.session)[0].contains("/no/such/folder/saved.txt"));
    assert!(viewer.dialog.is_shown());
}

/// Ctrl+S asks the first time. Then it writes the file that was chosen, until another scene is open or another program has
/// changed the file.
#[test]
fn ctrl_s_never_writes_a_file_that_was_not_chosen_for_this_scene() {
    let folder = folder(&[("given.txt", BALL), ("other.txt", FLOATING)]);
    let path = |name: &str| folder.path().join(name);
    let mut viewer = viewer(BALL);
    viewer.load(&path("given.txt"));
    viewer.command(Command::Save);
    // The proposed name is new, in the folder of the scene.
    assert_eq!(viewer.dialog.path, path("given-1.txt").display().to_string());
    let choice = viewer.dialog.confirm().expect("a new file needs no question");
    viewer.choose(&choice);
    assert!(path("given-1.txt").is_file() && !viewer.dialog.is_shown());

    viewer.command(Command::SingleStep);
    viewer.command(Command::Save);
    assert!(!viewer.dialog.is_shown(), "the same scene goes to the same file");
    let saved = Scene::load(path("given-1.txt")).expect("it reads back").scene;
    assert_eq!(saved.spheres(), as_text(viewer.session.simulation().scene()));

    fs::write(path("given-1.txt"), "changed by another program").expect("a file");
    viewer.command(Command::Save);
    assert!(viewer.dialog.is_shown() && viewer.dialog.confirm().is_none() && viewer.dialog.question().is_some());
    viewer.dialog.close();

    viewer.load(&path("other.txt"));
    viewer.command(Command::Save);
    assert!(viewer.dialog.is_shown(), "another scene goes to another file");
    assert_eq!(viewer.dialog.path, path("other-1.txt").display().to_string());
    assert_eq!(fs::read_to_string(path("given-1.txt")).expect("a file"), "changed by another program");
    assert_eq!(fs::read_to_string(path("given.txt")).expect("a file"), BALL);
}

/// A body has the name that the scene file gives it.
#[test]
fn the_picked_body_is_named_as_in_the_file() {
    let folder = folder(&[("named.txt", "a comment\nset gravity 0\nS 17 0 0 0 0 0 0 0 0 0 1 0.5\n")]);
    let mut viewer = viewer(BALL);
    viewer.load(&folder.path().join("named.txt"));
    let sight = crate::pointer::sight_of(&mut viewer.session, 0);
    viewer.session.pick(sight.origin, sight.direction);
    let facts = viewer.session.watch.facts().expect("facts");
    assert_eq!(facts.title, "sphere 17");
    assert!(facts.values.contains(&("line of the file", "3".to_owned())), "{facts:?}");
}

/// The table of the picked body has a line per step, and a file of its own.
#[test]
fn the_motion_of_the_picked_body_is_exported() {
    let folder = folder(&[]);
    let mut viewer = viewer(BALL);
    viewer.folder = folder.path().to_owned();
    let sight = crate::pointer::sight_of(&mut viewer.session, 0);
    viewer.session.pick(sight.origin, sight.direction);
    for _ in 0..10 {
        viewer.command(Command::SingleStep);
    }
    viewer.save_track();
    viewer.save_track();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a table");
    let text = read("test-sphere-1-1.csv");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "time,x,y,z,vx,vy,vz,height,speed");
    assert_eq!(lines.len(), 12, "{text}");
    // After 0.2 s of free fall from 3 units: 3 - 0.2² / 2.
    let last: Vec<f64> = lines[11].split(',').map(|number| number.parse().expect("a number")).collect();
    assert!((last[0] - 0.2).abs() < 1e-6 && (last[7] - 2.98).abs() < 1e-5 && (last[8] - 0.2).abs() < 1e-5, "{last:?}");
    assert_eq!(read("test-sphere-1-2.csv"), text);
}

/// The line of a scene file that says how it is run.
fn run_line(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a file");
    text.lines().find(|line| line.starts_with("@run")).unwrap_or_default().to_owned()
}

/// A scene that is opened brings its time step, unless one was given on the command line. A reset keeps that of the window.
#[test]
fn a_scene_brings_its_time_step() {
    let slow = format!("@run dt=0.004 integrator=symplectic-euler substeps=4\n{BALL}");
    let folder = folder(&[("plain.txt", FLOATING), ("slow.txt", &slow)]);
    let [plain, slow] = ["plain.txt", "slow.txt"].map(|name| folder.path().join(name));
    let mut session = session(BALL);
    session.set_time_step(0.01);
    session.load(&plain);
    assert_eq!(session.pace.time_step, 0.01, "it has none");
    session.load(&slow);
    assert_eq!((session.pace.time_step, session.simulation().time_step()), (0.001, 0.001));
    assert_eq!(session.simulation().integrator(), rockfall::Integrator::SymplecticEuler);
    let saved = folder.path().join("saved.txt");
    assert!(session.save(&saved));
    assert_eq!(run_line(&saved), "@run dt=0.004 integrator=symplectic-euler substeps=4");
    session.set_time_step(0.002);
    session.reset();
    assert_eq!(session.pace.time_step, 0.002);
    assert!(session.save(&saved));
    assert_eq!(run_line(&saved), "@run dt=0.002 integrator=symplectic-euler");
    session.load(&slow);
    session.load(&saved);
    assert_eq!(session.pace.time_step, 0.002);
    session.load(&plain);
    assert_eq!(session.pace.time_step, 0.02, "the step was that of the scene before");
    session.keeps_time_step = true;
    session.load(&slow);
    assert_eq!(session.pace.time_step, 0.02);
}
