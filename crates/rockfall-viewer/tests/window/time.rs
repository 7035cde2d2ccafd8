//! Frames, steps and samples of a running session.

use rockfall_viewer::window::session::Session;

use crate::common::*;

fn steps(session: &mut Session) -> u64 {
    session.simulation().report().steps
}

#[test]
fn a_stopped_session_makes_no_steps() {
    let mut session = session(BALL);
    for frame in 0..10 {
        session.frame(f64::from(frame), 1.0, |_| panic!("a stopped session makes a step"));
    }
    assert_eq!(steps(&mut session), 0);
}

#[test]
fn each_frame_makes_one_step_or_follows_the_clock() {
    let mut session = session(BALL);
    session.set_running(true);
    (0..10).for_each(|frame| session.frame(f64::from(frame), 0.1, |_| ()));
    assert_eq!(steps(&mut session), 10);
    session.pace.real_time = true;
    (0..10).for_each(|frame| session.frame(f64::from(frame), 0.05, |_| ()));
    // 0.5 s at 20 ms per step; in the first frame the cost of a step is not known yet.
    let done = steps(&mut session) - 10;
    assert!((23..=25).contains(&done), "{done}");
}

/// The picture blends from the state before the last step.
#[test]
fn the_callback_runs_before_the_last_step() {
    let mut session = session(BALL);
    session.set_running(true);
    session.frame(0.0, 0.02, |_| ());
    session.pace.real_time = true;
    let mut seen = Vec::new();
    for _ in 0..5 {
        session.frame(0.0, 0.06001, |simulation| seen.push(simulation.report().steps));
    }
    assert_eq!(seen.len(), 5);
    assert_eq!(seen[4] + 1, steps(&mut session));
}

/// 3e38 * 50 is greater than the greatest f32, so the position of the ball on that tether is not finite after the first step.
#[test]
fn a_position_that_is_not_finite_stops_the_session_with_a_message() {
    let mut session = session("S 1 0 0 0 0 0 0 0 0 0 1 0.5\nS 2 9 0 0 0 0 0 0 0 0 1 0.5\nT 1 0 50 0 3e38 0 0\n");
    session.set_running(true);
    (0..5).for_each(|frame| session.frame(f64::from(frame), 0.02, |_| ()));
    assert!(!session.running() && !session.device_failed());
    assert!(messages(&session)[0].starts_with("sphere 1 stopped being finite in step 1"), "{:?}", messages(&session));
    assert_eq!(steps(&mut session), 1);
    session.reset();
    assert_eq!((steps(&mut session), heights(&mut session)), (0, vec![0.0, 0.0]));
}

/// The potential energy of a falling ball becomes kinetic energy. There are at most four samples per second.
#[test]
fn energies_are_sampled_at_intervals() {
    let mut session = session(BALL);
    session.set_running(true);
    for frame in 0..100 {
        session.frame(f64::from(frame) * 0.01, 0.01, |_| ());
        session.sample(false);
    }
    let samples: Vec<_> = session.watch.energies().iter().copied().collect();
    assert!((3..=5).contains(&samples.len()), "{} samples in a second", samples.len());
    assert!((samples[0].energy.total() - samples[3].energy.total()).abs() < 1e-4);
    assert!(samples[3].energy.kinetic > 0.1);
    assert!(!session.watch.phases().is_empty());
    // While the session is stopped there are no new samples.
    session.set_running(false);
    (0..100).for_each(|frame| {
        session.frame(5.0 + f64::from(frame), 0.01, |_| ());
        session.sample(false);
    });
    assert!(session.watch.energies().len() <= samples.len() + 1);
}

/// Energies of many bodies take long to evaluate.
#[test]
fn large_scenes_are_sampled_only_on_request() {
    let scene = rockfall::generate::Kind::Pile.generate(100_001, 1).expect("a scene");
    let source = rockfall_viewer::window::session::Source { name: "pile".to_owned(), path: None, scene };
    let mut session = Session::open(source, Vec::new(), 0.02, on_cpu()).expect("it opens");
    session.frame(1.0, 0.0, |_| ());
    session.sample(false);
    assert!(session.watch.energies().is_empty() && !session.watch.is_unasked());
    session.sample(true);
    assert_eq!(session.watch.energies().len(), 1);
}

#[test]
fn an_invalid_time_step_gives_a_message_and_the_old_one_stays() {
    let mut session = session(BALL);
    session.set_time_step(f32::NAN);
    assert!(messages(&session)[0].contains("dt"));
    assert_eq!(session.pace.time_step, 0.02);
}

/// A time step that is too long, and bodies that sink into each other, are reported before the first step and once.
#[test]
fn a_scene_that_cannot_work_is_reported_before_it_runs() {
    let mut session = session(BALL);
    assert_eq!(messages(&session), Vec::<&str>::new());
    session.set_time_step(1.0);
    session.set_running(true);
    assert_eq!(steps(&mut session), 0);
    let stiff = "the contact force is too stiff for the time step";
    assert!(messages(&session).iter().any(|text| text.contains(stiff)), "{:?}", messages(&session));
    let shown = session.messages.all().len();
    session.set_running(false);
    session.set_running(true);
    assert_eq!(session.messages.all().len(), shown);

    let sinking =
        "set gravity 100\nS 1 0 3 0 0 0 0 0 0 0 1 0.05\nS 2 3 3 0 0 0 0 0 0 0 1 0.05\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n";
    let session = crate::common::session(sinking);
    assert!(messages(&session).iter().any(|text| text.starts_with("bodies at rest overlap")), "{:?}", messages(&session));
}

/// A warning of a time step that is too long appears when it is set, as soon as the user has stopped changing it.
#[test]
fn a_bad_time_step_or_constant_is_warned_of_when_it_is_set() {
    let stiff = "S 1 0 0 0 0 0 0 0 0 0 1 0.1\nS 2 1 0 0 0 0 0 0 0 0 1 0.1\nK 1 2 1000 1 0\n";
    let mut session = session(stiff);
    assert!(messages(&session).is_empty(), "{:?}", messages(&session));
    session.set_time_step(0.2);
    session.frame(0.2, 0.2, |_| ());
    assert!(messages(&session).is_empty(), "{:?}", messages(&session));
    session.frame(1.0, 0.8, |_| ());
    assert!(messages(&session).iter().any(|text| text.contains("0.0632 s")), "{:?}", messages(&session));
    // A time step that no simulation can have changes nothing and gives the reason.
    session.set_time_step(-0.01);
    assert_eq!(session.pace.time_step, 0.2);
    assert!(messages(&session)[0].contains("-0.01"), "{:?}", messages(&session));
}

/// A later warning of the same kind takes the place of the one before, and none stays that no longer holds.
#[test]
fn warnings_of_constants_do_not_pile_up() {
    let balls = "S 1 0 3 0 0 0 0 0 0 0 1 0.05\nS 2 3 3 0 0 0 0 0 0 0 1 0.05\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n";
    let mut session = session(balls);
    assert!(messages(&session).is_empty());
    for (number, gravity) in [100.0, 110.0, 120.0].into_iter().enumerate() {
        session.change_settings(|settings| settings.gravity = gravity);
        session.frame(10.0 * number as f64 + 1.0, 0.0, |_| ());
        session.frame(10.0 * number as f64 + 9.0, 0.0, |_| ());
    }
    let sinking = |session: &Session| messages(session).iter().filter(|text| text.starts_with("bodies at rest")).count();
    assert_eq!(sinking(&session), 1, "{:?}", messages(&session));
    session.change_settings(|settings| settings.gravity = 1.0);
    session.frame(90.0, 0.0, |_| ());
    assert_eq!(sinking(&session), 0, "{:?}", messages(&session));
}
