//! Trajectories that are played instead of simulated.

use rockfall::{Error, Simulation};
use rockfall_viewer::window::session::playback::Playback;

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
    Playback { name: "test".to_owned(), moments, show: Box::new(show) }
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
