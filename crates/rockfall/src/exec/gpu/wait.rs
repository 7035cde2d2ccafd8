//! Waiting for the device: futures that a browser drives, and a small executor for everything else.

use std::cell::Cell;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use crate::error::{Error, Result};
use crate::exec::gpu::fault::{Faults, lost};

thread_local! {
    /// What the future that was polled last on this thread waits for, where that is not all that was submitted: later submissions
    /// keep the device busy meanwhile, and whoever waited for those, too, would have it idle afterwards.
    static AWAITED: Cell<Option<wgpu::SubmissionIndex>> = const { Cell::new(None) };
}

#[derive(Debug, Default)]
struct Shared {
    done: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

/// Resolves when a buffer is mapped for reading.
#[derive(Debug)]
pub(crate) struct Mapped {
    buffer: wgpu::Buffer,
    shared: Arc<Mutex<Shared>>,
    faults: Faults,
    submission: Option<wgpu::SubmissionIndex>,
}

impl Mapped {
    /// Starts to map the whole buffer.
    pub(crate) fn read(buffer: &wgpu::Buffer, faults: &Faults) -> Self {
        let shared = Arc::new(Mutex::new(Shared::default()));
        let theirs = Arc::clone(&shared);
        buffer.map_async(wgpu::MapMode::Read, .., move |done| {
            let mut shared = theirs.lock().unwrap_or_else(PoisonError::into_inner);
            shared.done = Some(done);
            if let Some(waker) = shared.waker.take() {
                waker.wake();
            }
        });
        Self { buffer: buffer.clone(), shared, faults: faults.clone(), submission: None }
    }

    /// Has no later submission waited for than this one, which writes the buffer.
    pub(crate) fn after(self, submission: wgpu::SubmissionIndex) -> Self {
        Self { submission: Some(submission), ..self }
    }

    /// Waits until it is, and gives its bytes. `what` tells in errors what they are.
    ///
    /// # Errors
    /// [`Error::Device`] when the device is lost.
    pub(crate) async fn bytes(mut self, what: &str) -> Result<wgpu::BufferView> {
        (&mut self).await?;
        let view = self.buffer.get_mapped_range(..);
        view.map_err(|error| Error::Device(format!("{what} could not be read back: {error}")))
    }
}

impl Future for Mapped {
    type Output = Result<()>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(done) = shared.done.take() {
            // The device's own words, where there are any, tell more than "mapping failed".
            return Poll::Ready(match done {
                Ok(()) => self.faults.check(),
                Err(_) => self.faults.check().and(Err(Error::Device(lost("a buffer could not be read back")))),
            });
        }
        if let Err(error) = self.faults.check() {
            return Poll::Ready(Err(error));
        }
        shared.waker = Some(context.waker().clone());
        AWAITED.set(self.submission.clone());
        Poll::Pending
    }
}

/// Drives a future of this module to its end on the calling thread, waiting for the device where the future does.
///
/// # Errors
/// Those of the future, and [`Error::Device`] when the device cannot be waited for.
#[cfg(not(target_arch = "wasm32"))]
pub fn block_on<T>(device: &wgpu::Device, future: impl Future<Output = Result<T>>) -> Result<T> {
    drive(future, || wait(device))?
}

/// Polls until the future is ready, calling `when_pending` in between.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn drive<T>(future: impl Future<Output = T>, mut when_pending: impl FnMut() -> Result<()>) -> Result<T> {
    let mut future = std::pin::pin!(future);
    // Nobody needs to wake this thread: it comes back from `when_pending` by itself.
    let mut context = Context::from_waker(Waker::noop());
    loop {
        AWAITED.set(None);
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return Ok(value);
        }
        when_pending()?;
    }
}

/// What the future that was just polled waits for.
#[cfg(not(target_arch = "wasm32"))]
fn awaited() -> wgpu::PollType {
    wgpu::PollType::Wait { submission_index: AWAITED.take(), timeout: None }
}

#[cfg(not(target_arch = "wasm32"))]
fn wait(device: &wgpu::Device) -> Result<()> {
    let until = awaited();
    // wgpu panics where polling meets a lost device; that must not take the host program down.
    let polled = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| device.poll(until)));
    match polled {
        // What was waited for may belong to another thread: let it run.
        Ok(Ok(_)) => std::thread::yield_now(),
        Ok(Err(error)) => return Err(Error::Device(format!("waiting for the device failed: {error}"))),
        Err(_) => return Err(Error::Device(lost("while it was waited for"))),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::gpu::{Gpu, GpuWorld};
    use crate::generate::Benchmark;
    use crate::model::world::World;
    use crate::settings::{BroadPhase, Integrator};
    use crate::step::schedule::{Phase, Run};

    /// While the device works on the next steps, the host looks at the status after these. (That it is not late was seen on a GPU:
    /// software Vulkan begins with a submission when the one before is done, and blocks until then.)
    #[test]
    fn steps_are_waited_for_and_not_what_comes_after_them() {
        let gpu = Gpu::open_blocking(true).expect("the tests need an adapter, software will do");
        let world = World::build(&Benchmark::Lattice.generate(2_000, 0).unwrap()).unwrap();
        let mut there = GpuWorld::new(&gpu, &world).unwrap();
        let stages = |phase: Phase| phase.stages(Integrator::Rk4, BroadPhase::Grid).iter().copied();
        let runs: Vec<Run> = Phase::STEP.into_iter().flat_map(stages).collect();
        let status = there.run_and_look(&runs, &world.step, 0..30).unwrap();
        let mut waited_for = Vec::new();
        let wait_and_note = || {
            waited_for.push(awaited());
            wait(gpu.device())
        };
        drive(status, wait_and_note).unwrap().unwrap();
        let is_one = |until: &wgpu::PollType| matches!(until, wgpu::PollType::Wait { submission_index: Some(_), .. });
        assert!(!waited_for.is_empty() && waited_for.iter().all(is_one), "{waited_for:?}");
    }
}
