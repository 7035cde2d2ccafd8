//! Waiting for the device: futures that a browser can poll, and a small executor for native programs.

use std::cell::Cell;
use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use crate::error::{Error, Result};
use crate::exec::gpu::fault::{Faults, lost};

thread_local! {
    /// The submission that the future polled last on this thread waits for, or `None` if it waits for all submissions. Later
    /// submissions keep the device busy in the meantime. Waiting for them too would leave the device idle afterwards.
    static AWAITED: Cell<Option<wgpu::SubmissionIndex>> = const { Cell::new(None) };
}

#[derive(Debug, Default)]
struct Shared {
    done: Option<Result<(), wgpu::BufferAsyncError>>,
    waker: Option<Waker>,
}

/// A future that resolves when a buffer is mapped for reading.
#[derive(Debug)]
pub(crate) struct Mapped {
    buffer: wgpu::Buffer,
    shared: Arc<Mutex<Shared>>,
    faults: Faults,
    submission: Option<wgpu::SubmissionIndex>,
}

impl Mapped {
    /// Starts mapping the whole buffer.
    pub(crate) fn read(buffer: &wgpu::Buffer, faults: &Faults) -> Self {
        let shared = Arc::new(Mutex::new(Shared::default()));
        let shared_with_callback = Arc::clone(&shared);
        buffer.map_async(wgpu::MapMode::Read, .., move |done| {
            let mut shared = shared_with_callback.lock().unwrap_or_else(PoisonError::into_inner);
            shared.done = Some(done);
            if let Some(waker) = shared.waker.take() {
                waker.wake();
            }
        });
        Self { buffer: buffer.clone(), shared, faults: faults.clone(), submission: None }
    }

    /// Limits the wait to `submission`, the one that writes the buffer. Later submissions are not waited for.
    pub(crate) fn after(self, submission: wgpu::SubmissionIndex) -> Self {
        Self { submission: Some(submission), ..self }
    }

    /// Waits until the buffer is mapped and returns its bytes. `what` names the contents in error messages.
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
            // The fault that the device itself reported, if any, says more than "mapping failed".
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

/// Drives a future of this module to completion on the calling thread. Waits for the device whenever the future is pending.
///
/// # Errors
/// Those of the future, and [`Error::Device`] when waiting for the device fails.
#[cfg(not(target_arch = "wasm32"))]
pub fn block_on<T>(device: &wgpu::Device, future: impl Future<Output = Result<T>>) -> Result<T> {
    drive(future, || wait(device))?
}

/// Polls the future until it is ready, and calls `when_pending` between polls.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn drive<T>(future: impl Future<Output = T>, mut when_pending: impl FnMut() -> Result<()>) -> Result<T> {
    let mut future = std::pin::pin!(future);
    // No waker is needed: this thread polls again as soon as `when_pending` returns.
    let mut context = Context::from_waker(Waker::noop());
    loop {
        AWAITED.set(None);
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return Ok(value);
        }
        when_pending()?;
    }
}

/// The wait that the future polled last asks for.
#[cfg(not(target_arch = "wasm32"))]
fn awaited() -> wgpu::PollType {
    wgpu::PollType::Wait { submission_index: AWAITED.take(), timeout: None }
}

#[cfg(not(target_arch = "wasm32"))]
fn wait(device: &wgpu::Device) -> Result<()> {
    let until = awaited();
    // wgpu panics when it polls a lost device. That must not abort the host program.
    let polled = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| device.poll(until)));
    match polled {
        // The awaited result may belong to another thread, so let other threads run.
        Ok(Ok(_)) => std::thread::yield_now(),
        Ok(Err(error)) => return Err(Error::Device(format!("waiting for the device failed: {error}"))),
        Err(_) => return Err(Error::Device(lost("while waiting for it"))),
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

    /// The host waits for the status after its own steps only, while the device works on the next ones. This test checks which
    /// submission is awaited, not the timing: software Vulkan starts a submission when the one before is done, and blocks until
    /// then. The timing was checked on a GPU.
    #[test]
    fn waiting_for_steps_does_not_wait_for_later_submissions() {
        let gpu = Gpu::open_blocking(true).expect("the tests need an adapter; a software one is enough");
        let world = World::build(&Benchmark::Lattice.generate(2_000, 0).unwrap()).unwrap();
        let mut gpu_world = GpuWorld::new(&gpu, &world).unwrap();
        let stages = |phase: Phase| phase.stages(Integrator::Rk4, BroadPhase::Grid).iter().copied();
        let runs: Vec<Run> = Phase::STEP.into_iter().flat_map(stages).collect();
        let status = gpu_world.run_and_read_status(&runs, &world.step, 0..30).unwrap();
        let mut waited_for = Vec::new();
        let wait_and_note = || {
            waited_for.push(awaited());
            wait(gpu.device())
        };
        drive(status, wait_and_note).unwrap().unwrap();
        let is_single_submission =
            |until: &wgpu::PollType| matches!(until, wgpu::PollType::Wait { submission_index: Some(_), .. });
        assert!(!waited_for.is_empty() && waited_for.iter().all(is_single_submission), "{waited_for:?}");
    }
}
