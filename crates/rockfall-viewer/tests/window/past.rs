//! Undo and redo of edits, and going back in time.

use rockfall_viewer::window::controls::Command;
use rockfall_viewer::window::session::Session;

use crate::common::*;

/// Runs frames of one step.
fn run(session: &mut Session, frames: u32) {
    session.set_running(true);
    (0..frames).for_each(|frame| session.frame(f64::from(frame), 0.02, |_| ()));
    session.set_running(false);
}

fn steps(session: &Session) -> u64 {
    session.simulation_ref().report().steps
}

#[test]
fn changes_of_constants_are_undone_and_redone() {
    let mut viewer = viewer(BALL);
    let gravity = |viewer: &rockfall_viewer::window::viewer::Viewer| viewer.session.settings().gravity;
    // Several presses of a key within a second are one edit; another constant is another edit.
    (0..3).for_each(|_| viewer.command(Command::Nudge { constant: 4, up: true }));
    viewer.command(Command::ToggleCollisions);
    viewer.session.set_time_step(0.01);
    viewer.command(Command::Undo);
    assert_eq!(viewer.session.pace.time_step, 0.02);
    viewer.command(Command::Undo);
    assert!(viewer.session.settings().collisions && gravity(&viewer) == 1.75);
    viewer.command(Command::Undo);
    assert_eq!(gravity(&viewer), 1.0);
    assert_eq!(viewer.session.can_undo(), [false, true]);
    viewer.command(Command::Undo);
    assert_eq!(messages(&viewer.session)[0], "there is nothing to undo");
    (0..3).for_each(|_| viewer.command(Command::Redo));
    assert_eq!((gravity(&viewer), viewer.session.settings().collisions, viewer.session.pace.time_step), (1.75, false, 0.01));
    assert_eq!(viewer.session.can_undo(), [true, false]);
}

/// With `resting_overlap`, the simulation chooses constants for the present positions when constants change. Undo does not.
#[test]
fn undo_brings_chosen_constants_back() {
    let text = "# Falling balls\nset gravity 10\nset resting_overlap 0.02\nB -9 -1 -9 18 0 0 0 1 0 0 0 18\n\
                S 1 0 0.5 0 0 0 0 0 0 0 1 0.5\nS 2 0 1.6 0 2 0 0 0 0 0 1 0.5\nS 3 0 2.7 0 -3 0 0 0 0 0 1 0.5\n";
    let folder = tempfile::tempdir().expect("a folder");
    let [given, saved] = ["given.txt", "saved.txt"].map(|name| folder.path().join(name));
    std::fs::write(&given, text).expect("a file");
    let mut session = session(BALL);
    assert!(session.load(&given));
    session.set_time_step(0.001);
    run(&mut session, 300);
    let before = *session.settings();
    let places = heights(&mut session);
    session.change_settings(|settings| settings.gravity = 11.0);
    let after = *session.settings();
    session.undo();
    assert_eq!((*session.settings(), heights(&mut session), steps(&session)), (before, places, 300));
    session.redo();
    assert_eq!(*session.settings(), after);
    // The file has the constants in effect, with which it goes on, and the title of the scene.
    assert!(session.save(&saved));
    let loaded = rockfall::Scene::load(&saved).expect("it reads back");
    assert_eq!(loaded.title, ["Falling balls"]);
    let mut expected = after;
    expected.resting_overlap = 0.0;
    assert_eq!(loaded.scene.resolved_settings(), expected);
    let text = std::fs::read_to_string(&saved).expect("a file");
    assert!(text.contains("# contact_force and contact_damping were chosen for resting_overlap 0.02\n"), "{text}");
}

#[test]
fn a_throw_is_undone_and_redone() {
    let mut viewer = viewer(FLOATING);
    run(&mut viewer.session, 10);
    viewer.command(Command::Throw);
    run(&mut viewer.session, 5);
    viewer.command(Command::Undo);
    assert_eq!((viewer.session.simulation().scene().counts().spheres, steps(&viewer.session)), (2, 10));
    viewer.command(Command::Redo);
    assert_eq!((viewer.session.simulation().scene().counts().spheres, steps(&viewer.session)), (3, 15));
}

#[test]
fn a_pull_is_undone() {
    let mut session = session(FLOATING);
    run(&mut session, 3);
    let sight = crate::pointer::sight_of(&mut session, 0);
    session.hold(&sight);
    let aside = rockfall_viewer::window::hold::Sight { origin: sight.origin + rockfall::glam::Vec3::Y, ..sight };
    session.drag(&aside);
    run(&mut session, 50);
    session.release();
    assert!(heights(&mut session)[0] > 0.5);
    session.undo();
    assert_eq!((heights(&mut session), steps(&session)), (vec![0.0, 0.0], 3));
    assert_eq!(session.simulation().scene().counts().tethers, 0);
}

/// Neither a reset nor another scene loses the state before.
#[test]
fn a_reset_and_the_opening_of_a_scene_are_undone() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("floating.txt");
    std::fs::write(&path, FLOATING).expect("a file");
    let mut viewer = viewer(BALL);
    run(&mut viewer.session, 10);
    viewer.command(Command::Nudge { constant: 4, up: true });
    let before = heights(&mut viewer.session);
    viewer.command(Command::Reset);
    assert_eq!((steps(&viewer.session), viewer.session.settings().gravity), (0, 1.0));
    viewer.command(Command::Undo);
    assert_eq!((steps(&viewer.session), viewer.session.settings().gravity), (10, 1.25));
    assert_eq!(heights(&mut viewer.session), before);
    let camera = viewer.camera;
    viewer.load(&path);
    assert_eq!(heights(&mut viewer.session).len(), 2);
    viewer.command(Command::Undo);
    assert_eq!((heights(&mut viewer.session), viewer.session.source().name.as_str()), (before, "test"));
    assert_eq!(viewer.camera, camera);
}

/// Going back and running on gives the same states as before.
#[test]
fn the_last_seconds_can_be_visited_and_repeated() {
    let mut session = session(BALL);
    run(&mut session, 200);
    let last = heights(&mut session);
    let times: Vec<f64> = session.past().times().collect();
    // A state every 0.05 s, which is every third step.
    assert!(times.len() > 50 && times[0] == 0.0 && *times.last().expect("a state") > 3.9, "{times:?}");
    session.seek(2.0);
    let there = steps(&session);
    assert!((98..=102).contains(&there) && !session.running(), "{there}");
    // The ball fell for about 2 s from 3 units.
    let fallen = 0.5 * (there as f32 * 0.02).powi(2);
    assert!((heights(&mut session)[0] - (3.0 - fallen)).abs() < 1e-3, "{:?}", heights(&mut session));
    // The present was recorded, so one can return to it.
    session.seek(100.0);
    assert_eq!((steps(&session), heights(&mut session)), (200, last.clone()));
    session.rewind(false);
    session.rewind(false);
    assert!(steps(&session) < 200);
    session.rewind(true);
    session.rewind(true);
    assert_eq!(steps(&session), 200);
    // Running on from the past repeats the steps bitwise identically.
    session.seek(2.0);
    run(&mut session, 200 - u32::try_from(there).expect("few steps"));
    assert_eq!(heights(&mut session), last);
    let times: Vec<f64> = session.past().times().collect();
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
}

/// Going back moves bodies, not sliders. Samples of the time after it are removed.
#[test]
fn going_back_keeps_the_constants_and_removes_later_samples() {
    let mut session = session(BALL);
    let sight = crate::pointer::sight_of(&mut session, 0);
    session.pick(sight.origin, sight.direction);
    for frame in 0..100 {
        session.set_running(true);
        session.frame(f64::from(frame) * 0.3, 0.02, |_| ());
        session.sample(false);
    }
    session.change_settings(|settings| settings.gravity = 3.0);
    let before = session.watch.energies().len();
    session.seek(1.0);
    assert_eq!(session.settings().gravity, 3.0);
    let time = session.simulation_ref().report().time;
    assert!(session.watch.energies().iter().all(|sample| sample.time <= time) && session.watch.energies().len() < before);
    assert!(session.track().points().iter().all(|point| point.time <= time));
    assert!(session.picked().is_some());
}

/// On a slow device a frame has many steps. States within the frame are recorded as well.
#[test]
fn the_states_within_a_slow_frame_are_recorded() {
    let mut session = session(BALL);
    session.pace.real_time = true;
    session.pace.note_cost(1, 1e-6);
    let sight = crate::pointer::sight_of(&mut session, 0);
    session.pick(sight.origin, sight.direction);
    session.set_running(true);
    (0..3).for_each(|frame| session.frame(f64::from(frame), 1.0, |_| ()));
    assert_eq!(steps(&session), 150);
    assert!(session.past().times().len() > 20, "{} states", session.past().times().len());
    assert!(session.track().points().len() > 20, "{} points", session.track().points().len());
}

#[test]
fn huge_scenes_are_not_recorded() {
    let text: String = (0..150_000).map(|ball| format!("S {ball} {ball} 0 0 0 0 0 0 0 0 1 0.4\n")).collect();
    let mut session = session(&text);
    assert!(!session.can_rewind());
    session.single_step();
    assert_eq!(session.past().times().len(), 0);
    session.seek(0.0);
    assert_eq!(steps(&session), 1);
}
