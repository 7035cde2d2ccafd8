//! Each command changes what it should change and nothing else.

use std::collections::BTreeMap;

use rockfall::glam::{Vec2, Vec3};
use rockfall::{ContactLaw, Integrator, Settings};
use rockfall_viewer::camera::{Camera, Direction, Vertical};
use rockfall_viewer::window::constants::CONSTANTS;
use rockfall_viewer::window::controls::Command;
use rockfall_viewer::window::viewer::Viewer;

use crate::common::*;

/// Returns all state that a command can change, by name.
fn state(viewer: &mut Viewer) -> BTreeMap<String, String> {
    let session = &mut viewer.session;
    let settings = *session.settings();
    let mut state: BTreeMap<String, String> =
        Settings::NAMES.iter().map(|name| ((*name).to_owned(), settings.get(name).expect("a setting"))).collect();
    let mut add = |name: &str, value: String| drop(state.insert(name.to_owned(), value));
    add("running", session.running().to_string());
    add("real time", session.pace.real_time.to_string());
    add("speed", session.pace.speed().to_string());
    add("time step", session.pace.time_step.to_string());
    add("spheres", session.simulation().scene().counts().spheres.to_string());
    add("steps", session.simulation().report().steps.to_string());
    add("positions", format!("{:?}", heights(session)));
    add("held", session.held().is_some().to_string());
    add("scene", session.scene_version().to_string());
    add("messages", session.messages.all().len().to_string());
    add("camera", format!("{:?}", viewer.camera));
    add("help", viewer.help.to_string());
    add("panel", viewer.panel.to_string());
    add("dialog", viewer.dialog.is_shown().to_string());
    add("style", format!("{:?}", viewer.style));
    add("all messages", viewer.messages.to_string());
    add("quit", viewer.quit.to_string());
    add("leaving", viewer.leaving.to_string());
    add("following", viewer.is_following().to_string());
    state
}

#[track_caller]
fn changes(viewer: &mut Viewer, command: Command, expected: &[(&str, &str)]) {
    let before = state(viewer);
    viewer.command(command);
    let after = state(viewer);
    let changed: Vec<(&str, &str)> = after
        .iter()
        .filter(|(name, value)| before[*name] != **value)
        .map(|(name, value)| (name.as_str(), value.as_str()))
        .collect();
    assert_eq!(changed, expected, "{command:?}");
}

#[test]
fn the_numbers_look_along_the_axes() {
    let mut viewer = viewer("S 1 0 5 0 0 0 0 0 0 0 1 0.5\nS 2 3 5 1 0 0 0 0 0 0 1 0.5\n");
    for direction in Direction::NAMED {
        viewer.command(Command::LookFrom(direction));
        let Camera { eye, target, .. } = viewer.camera;
        assert!((eye - target).normalize().distance(direction.to_camera()) < 1e-5, "{direction:?}: {eye} {target}");
        assert_eq!(target, Vec3::new(1.5, 5.0, 0.5));
    }
}

/// A direction that was asked for is that of every scene, also after the camera was moved.
#[test]
fn a_window_shows_scenes_from_a_direction() {
    let mut viewer = viewer("S 1 0 5 0 0 0 0 0 0 0 1 0.5\nS 2 3 5 1 0 0 0 0 0 0 1 0.5\n");
    let looks_from = |viewer: &Viewer, direction: Direction| {
        let Camera { eye, target, .. } = viewer.camera;
        (eye - target).normalize().distance(direction.to_camera()) < 1e-5
    };
    assert!(looks_from(&viewer, Direction::Oblique));
    viewer.show_from(Direction::Side, Vertical::Auto);
    assert!(looks_from(&viewer, Direction::Side));
    viewer.command(Command::LookFrom(Direction::Top));
    viewer.command(Command::ResetCamera);
    assert!(looks_from(&viewer, Direction::Side));
    viewer.resize(viewer.size() * 0.5);
    assert!(looks_from(&viewer, Direction::Side));
}

#[test]
fn toggles_switch_on_and_off() {
    let cases: [(Command, &str, [&str; 2]); 7] = [
        (Command::Help, "help", ["true", "false"]),
        (Command::TogglePanel, "panel", ["false", "true"]),
        (Command::ToggleRunning, "running", ["true", "false"]),
        (Command::ToggleCollisions, "collisions", ["off", "on"]),
        (Command::ToggleRealTime, "real time", ["true", "false"]),
        (Command::ToggleMessages, "all messages", ["true", "false"]),
        (Command::Open, "dialog", ["true", ""]),
    ];
    for (command, name, [on, off]) in cases {
        let mut viewer = viewer(BALL);
        changes(&mut viewer, command, &[(name, on)]);
        if !off.is_empty() {
            changes(&mut viewer, command, &[(name, off)]);
        }
    }
}

#[test]
fn commands_raise_and_lower_constants() {
    for (constant, at) in CONSTANTS.iter().enumerate() {
        let mut viewer = viewer(BALL);
        let value = |steps: f32| (at.default_value() + steps * at.step).to_string();
        changes(&mut viewer, Command::Nudge { constant, up: true }, &[(at.name, &value(1.0))]);
        changes(&mut viewer, Command::Nudge { constant, up: false }, &[(at.name, &value(0.0))]);
        changes(&mut viewer, Command::Nudge { constant, up: false }, &[(at.name, &value(-1.0))]);
    }
}

/// The ball falls g dt² / 2 = 2e-4 in one step from rest.
#[test]
fn a_single_step_is_one_step_and_stops_the_simulation() {
    let mut viewer = viewer(BALL);
    changes(&mut viewer, Command::SingleStep, &[("positions", "[2.9998]"), ("steps", "1")]);
    viewer.command(Command::ToggleRunning);
    viewer.command(Command::SingleStep);
    assert!(!viewer.session.running());
}

#[test]
fn commands_lower_and_raise_the_speed() {
    let mut viewer = viewer(BALL);
    changes(&mut viewer, Command::ChangeSpeed { faster: false }, &[("speed", "0.5")]);
    changes(&mut viewer, Command::ChangeSpeed { faster: true }, &[("speed", "1")]);
}

/// The camera stays where it is.
#[test]
fn a_reset_restores_the_scene() {
    let mut viewer = viewer(BALL);
    viewer.command(Command::Throw);
    (0..3).for_each(|_| viewer.command(Command::SingleStep));
    viewer.command(Command::Nudge { constant: 4, up: true });
    viewer.scroll(2.0);
    let camera = viewer.camera;
    changes(
        &mut viewer,
        Command::Reset,
        &[("gravity", "1"), ("messages", "2"), ("positions", "[3.0]"), ("spheres", "1"), ("steps", "0")],
    );
    assert_eq!(viewer.camera, camera);
    changes(&mut viewer, Command::ResetCamera, &[("camera", &format!("{:?}", crate::common::viewer(BALL).camera))]);
}

/// Escape closes one thing after the other, and the window last.
#[test]
fn escape_closes_what_is_open_before_the_window() {
    let mut viewer = viewer(BALL);
    let ball = viewer.session.simulation_ref().scene().sphere_ids().next().expect("a ball");
    viewer.session.set_picked(Some(rockfall::Body::Sphere(ball)));
    viewer.command(Command::ToggleMessages);
    viewer.command(Command::Help);
    viewer.busy = true;
    viewer.command(Command::Open);
    changes(&mut viewer, Command::Close, &[("dialog", "false")]);
    // A menu or a field: the widgets close it.
    changes(&mut viewer, Command::Close, &[]);
    changes(&mut viewer, Command::Close, &[("help", "false")]);
    changes(&mut viewer, Command::Close, &[("all messages", "false")]);
    changes(&mut viewer, Command::Close, &[]);
    assert_eq!(viewer.session.picked(), None, "the window of the picked body");
    changes(&mut viewer, Command::Close, &[("quit", "true")]);
}

#[test]
fn the_home_key_and_f_show_the_whole_scene() {
    let initial = viewer(BALL).camera;
    let mut viewer = viewer(BALL);
    viewer.slide(Vec2::new(100.0, 40.0));
    viewer.scroll(6.0);
    viewer.command(Command::FrameAll);
    let seen = |viewer: &Viewer, point: Vec3| {
        let place = viewer.camera.view_projection(viewer.aspect()).project_point3(point);
        place.x.abs() < 1.0 && place.y.abs() < 1.0
    };
    assert!(seen(&viewer, Vec3::new(0.0, 3.5, 0.0)) && seen(&viewer, Vec3::new(0.0, 2.5, 0.0)));
    assert!((viewer.camera.axes().forward - initial.axes().forward).length() < 1e-4, "F keeps the direction");
    viewer.command(Command::ResetCamera);
    assert_eq!(viewer.camera, initial);
}

/// The thrown sphere has the radius and the mass of the others.
#[test]
fn a_thrown_sphere_flies_to_the_target_of_the_camera() {
    let mut viewer = viewer(FLOATING);
    let target = viewer.camera.target;
    viewer.command(Command::Throw);
    let spheres = viewer.session.simulation().spheres().expect("spheres are read");
    let (thrown, other) = (spheres[2], spheres[0]);
    assert_eq!((thrown.radius, thrown.mass), (other.radius, other.mass));
    let closest = (target - thrown.position).reject_from(thrown.velocity).length();
    assert!(closest < 1e-3 && thrown.velocity.dot(target - thrown.position) > 0.0, "{thrown:?} misses {target}");
}

/// While the simulation is stopped, every thrown sphere gets a place of its own, and no sphere overlaps another one.
#[test]
fn spheres_that_are_thrown_while_stopped_do_not_overlap() {
    let mut viewer = viewer(FLOATING);
    for _ in 0..40 {
        viewer.command(Command::Throw);
    }
    let spheres = viewer.session.simulation().spheres().expect("spheres are read");
    assert!((6..=14).contains(&spheres.len()), "{} spheres", spheres.len());
    for (index, one) in spheres.iter().enumerate() {
        for other in &spheres[..index] {
            assert!(one.position.distance(other.position) >= one.radius + other.radius);
        }
    }
    assert!(messages(&viewer.session).iter().any(|text| text.contains("no room")), "{:?}", messages(&viewer.session));
}

/// Esc never loses changes: it asks, and Esc again goes on. Only Ctrl+Q answers the question.
#[test]
fn unsaved_changes_are_asked_about() {
    let mut viewer = viewer(BALL);
    viewer.command(Command::SingleStep);
    assert!(!viewer.session.is_changed(), "steps are no changes");
    viewer.command(Command::Nudge { constant: 4, up: true });
    for _ in 0..2 {
        changes(&mut viewer, Command::Close, &[("leaving", "true")]);
        changes(&mut viewer, Command::Close, &[("leaving", "false")]);
    }
    viewer.command(Command::Undo);
    viewer.command(Command::Redo);
    changes(&mut viewer, Command::Quit, &[("leaving", "true")]);
    changes(&mut viewer, Command::Quit, &[("leaving", "false"), ("quit", "true")]);
}

#[test]
fn saved_changes_and_a_reset_scene_are_not_asked_about() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut viewer = viewer(BALL);
    viewer.command(Command::Throw);
    assert!(viewer.session.is_changed() && viewer.session.save(&folder.path().join("saved.txt")));
    assert!(!viewer.session.is_changed());
    viewer.command(Command::Throw);
    viewer.command(Command::Reset);
    assert!(!viewer.session.is_changed());
    changes(&mut viewer, Command::Close, &[("quit", "true")]);
}

/// Undo back to what was opened or saved leaves no changes. What cannot be undone stays a change.
#[test]
fn edits_that_were_undone_are_no_changes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut viewer = viewer(BALL);
    let mut is_changed = |commands: &[Command]| {
        commands.iter().for_each(|command| viewer.command(*command));
        viewer.session.is_changed()
    };
    let nudge = Command::Nudge { constant: 4, up: true };
    assert!(is_changed(&[nudge, Command::Throw, Command::Undo]));
    assert!(!is_changed(&[Command::Undo]));
    assert!(is_changed(&[Command::Redo]));
    assert!(is_changed(&[Command::Throw]));
    assert!(viewer.session.save(&folder.path().join("saved.txt")));
    viewer.command(Command::Undo);
    assert!(viewer.session.is_changed(), "the thrown sphere is in the file only");
    viewer.command(Command::Redo);
    assert!(!viewer.session.is_changed());
    // A reset can be undone, and then the changes are back.
    viewer.command(nudge);
    viewer.command(Command::Reset);
    assert!(!viewer.session.is_changed());
    viewer.command(Command::Undo);
    assert!(viewer.session.is_changed());
}

#[test]
fn one_key_starts_the_scene_again() {
    let mut viewer = viewer(BALL);
    (0..5).for_each(|_| viewer.command(Command::SingleStep));
    viewer.command(Command::Restart);
    assert!(viewer.session.running() && heights(&mut viewer.session) == [3.0]);
}

/// The contact law takes the place of an integrator of the scene that it does not allow.
#[test]
fn a_contact_law_replaces_an_integrator_that_it_does_not_allow() {
    let scene =
        |materials: &str| format!("@run integrator=rk4 dt=0.001\n@material wood young=5e6 poisson=0.3\n{materials}{BALL}");
    let mut session = session(&scene("@use wood\n"));
    session.single_step();
    let law = |law: ContactLaw| move |settings: &mut Settings| settings.contact_law = law;
    session.change_settings(law(ContactLaw::HertzMindlin));
    assert!(messages(&session).iter().any(|text| text.contains("velocity-verlet")), "{:?}", messages(&session));
    let simulation = session.simulation_ref();
    assert_eq!((simulation.integrator(), simulation.report().steps), (Integrator::VelocityVerlet, 1));
    session.single_step();
    assert_eq!(session.simulation_ref().report().steps, 2);
    session.undo();
    assert_eq!(session.settings().contact_law, ContactLaw::Thesis);
    let simulation = session.simulation_ref();
    assert_eq!((simulation.integrator(), simulation.report().steps), (Integrator::Rk4, 2));
    // A scene that the law refuses stays as it is.
    let mut session = crate::common::session(&scene(""));
    session.change_settings(law(ContactLaw::HertzMindlin));
    assert_eq!(session.simulation_ref().integrator(), Integrator::Rk4);
    assert_eq!(session.simulation_ref().scene().run.integrator, Some(Integrator::Rk4.into()));
    session.single_step();
    assert_eq!(session.simulation_ref().report().steps, 1);
}
