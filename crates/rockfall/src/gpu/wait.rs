//! Waiting for the device: futures that a browser drives, and a small executor for everything else.

use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use crate::error::{Error, Result};
use crate::gpu::fault::{Faults, lost};

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
        Self { buffer: buffer.clone(), shared, faults: faults.clone() }
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
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return Ok(value);
        }
        when_pending()?;
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn wait(device: &wgpu::Device) -> Result<()> {
    // wgpu panics where polling meets a lost device; that must not take the host program down.
    let polled = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| device.poll(wgpu::PollType::wait_indefinitely())));
    match polled {
        // What was waited for may belong to another thread: let it run.
        Ok(Ok(_)) => std::thread::yield_now(),
        Ok(Err(error)) => return Err(Error::Device(format!("waiting for the device failed: {error}"))),
        Err(_) => return Err(Error::Device(lost("while it was waited for"))),
    }
    Ok(())
}
