//! Loss of the graphics device that runs the simulation.

use rockfall::exec::gpu::Gpu;
use rockfall::{Options, Scene, Simulation};
use rockfall_viewer::window::session::{Opener, Session};

use crate::common::*;

fn on(gpu: &Gpu) -> Opener {
    let (device, queue) = (gpu.device().clone(), gpu.queue().clone());
    Box::new(move |scene: Scene| Simulation::on_device(scene, Options::new(), &device, &queue))
}

/// A message reports the loss, nothing runs on the lost device, and another device continues from the state that was read
/// back last.
#[test]
fn a_lost_device_is_reported_and_another_one_continues() {
    let gpu = Gpu::open_blocking(true).expect("a Vulkan driver; scripts/test installs one");
    let mut session = Session::open(source(BALL, None), Vec::new(), 0.02, on(&gpu)).expect("it opens");
    session.pace.real_time = false;
    session.set_running(true);
    for frame in 0..5 {
        session.frame(f64::from(frame), 0.02, |_| ());
    }
    session.sample(true);
    let sampled = heights(&mut session);
    assert!(sampled[0] < 3.0);
    session.frame(6.0, 0.02, |_| ());

    gpu.device().destroy();
    session.frame(7.0, 0.02, |_| ());
    assert!(session.device_failed(), "{:?}", messages(&session));
    session.frame(8.0, 0.02, |_| panic!("nothing runs on a lost device"));

    let another = Gpu::open_blocking(true).expect("it opened before");
    session.reopen(on(&another));
    assert!(!session.device_failed());
    assert!(messages(&session)[0].contains("lost"), "{:?}", messages(&session));
    assert_eq!(heights(&mut session), sampled);
    session.set_running(true);
    session.frame(9.0, 0.02, |_| ());
    assert!(heights(&mut session)[0] < sampled[0]);
}

/// On the GPU the past is restored without opening the scene again, and the same steps follow bitwise.
#[test]
fn the_past_is_restored_on_the_gpu() {
    let gpu = Gpu::open_blocking(true).expect("a Vulkan driver; scripts/test installs one");
    let mut session = Session::open(source(BALL, None), Vec::new(), 0.02, on(&gpu)).expect("it opens");
    session.pace.real_time = false;
    let run = |session: &mut Session, frames: u32| {
        session.set_running(true);
        (0..frames).for_each(|frame| session.frame(f64::from(frame), 0.02, |_| ()));
    };
    run(&mut session, 30);
    let last = heights(&mut session);
    session.throw([0.0, 9.0, 5.0].into(), [0.0, -1.0, 0.0].into());
    run(&mut session, 5);
    session.undo();
    assert_eq!(heights(&mut session), last);
    session.seek(0.3);
    let done = session.simulation().report().steps;
    assert!((13..=17).contains(&done), "{done}");
    run(&mut session, 30 - u32::try_from(done).expect("few steps"));
    assert_eq!(heights(&mut session), last);
    assert!(!session.device_failed(), "{:?}", messages(&session));
}
