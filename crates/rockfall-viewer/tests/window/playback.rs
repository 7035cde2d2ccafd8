//! Trajectories that are played instead of simulated.

use rockfall::glam::{Vec2, Vec3};
use rockfall::{Error, Simulation};
use rockfall_viewer::survey::Survey;
use rockfall_viewer::window::session::playback::Playback;
use rockfall_viewer::window::viewer::Viewer;

use crate::common::*;

/// A ball whose height in frame k is 3 + k; the frames are 10 steps and 0.1 s apart.
fn playback() -> Playback {
    let show = |frame: usize, simulation: &mut Simulation| -> rockfall::Result<()> {
        let ids: Vec<_> = simulation.scene().sphere_ids().collect();
        if ids.len() != 1 {
            return Err(Error::Invalid { field: "frame", value: "1 sphere".to_owned(), expected: "as many as the scene" });
        }
        simulation.set_position(ids[0], [0.0, 3.0 + frame as f32, 0.0])
    };
    let moments = (0..5).map(|frame| (10 * frame, 0.1 * frame as f64)).collect();
    Playback { name: "test".to_owned(), moments, show: Box::new(show), survey: Some(survey()) }
}

/// The ball in its first and last frame, 20 units higher.
fn survey() -> Survey {
    let scene = |height: f32| source(&BALL.replacen("S 1 0 3", &format!("S 1 0 {height}"), 1), None).scene;
    let mut survey = Survey::new(&scene(3.0));
    survey.add(&scene(23.0));
    survey
}

#[test]
fn the_camera_shows_all_frames() {
    let mut session = session(BALL);
    session.play(playback());
    let viewer = Viewer::new(session, Vec2::new(800.0, 600.0));
    for height in [3.0, 23.0] {
        let ndc = viewer.camera.view_projection(viewer.aspect()).project_point3(Vec3::new(0.0, height, 0.0));
        assert!(ndc.truncate().abs().max_element() < 1.0, "{height}: {ndc}");
    }
}

/// The time between two frames is not the time step of the run, nor of a scene that is opened later.
#[test]
fn a_trajectory_has_the_time_step_of_its_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.txt");
    std::fs::write(&path, BALL).expect("a file");
    let mut session = session(BALL);
    session.play(playback());
    session.pace.time_step = 0.1;
    assert_eq!(session.played().and_then(Playback::step_of_run), Some(0.01));
    session.load(&path);
    assert_eq!(session.pace.time_step, 0.02);
    session.undo();
    assert_eq!(session.pace.time_step, 0.1);
    session.throw([0.0, 9.0, 0.0].into(), [0.0; 3].into());
    session.single_step();
    assert_eq!(session.pace.time_step, 0.01);
}

#[test]
fn steps_show_the_frames_and_the_last_one_stops() {
    let mut session = session(BALL);
    session.play(playback());
    assert!(session.is_playing_back());
    session.single_step();
    assert_eq!(heights(&mut session), [4.0]);
    let report = session.simulation().report();
    assert_eq!((report.steps, report.time), (10, 0.1));
    session.set_running(true);
    (0..10).for_each(|frame| session.frame(f64::from(frame), 0.02, |_| ()));
    assert_eq!((heights(&mut session), session.running()), (vec![7.0], false));
    assert!(messages(&session)[0].contains("ends here"));
    // A reset plays it again.
    session.reset();
    assert_eq!(heights(&mut session), [3.0]);
    session.single_step();
    assert_eq!(heights(&mut session), [4.0]);
}

#[test]
fn a_scene_that_was_changed_is_simulated() {
    let mut session = session(BALL);
    session.play(playback());
    session.throw([0.0, 9.0, 0.0].into(), [0.0; 3].into());
    session.single_step();
    assert!(!session.is_playing_back() && messages(&session)[0].contains("simulated"));
}
