//! One device for many simulations of a process.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::{Mutex, PoisonError};

use crate::exec::gpu::Gpu;

thread_local! {
    static SHARES: Cell<bool> = const { Cell::new(false) };
}

/// The device that was opened last by a thread that shares.
static SHARED: Mutex<Option<Gpu>> = Mutex::new(None);

/// While this lives, the thread opens no device of its own if another one that shares has done so already. It takes that one, with
/// the kernels that are compiled. For tests: software Vulkan needs seconds for a kernel, and each test has simulations of its own.
///
/// Programs do not share, because an error of a device would end all simulations on it.
#[doc(hidden)]
#[derive(Debug)]
pub struct SharedDevice {
    before: bool,
    /// It belongs to its thread.
    _of_thread: PhantomData<*const ()>,
}

impl SharedDevice {
    /// Begins to share.
    #[expect(clippy::new_without_default, reason = "it has an effect")]
    pub fn new() -> Self {
        Self { before: SHARES.replace(true), _of_thread: PhantomData }
    }
}

impl Drop for SharedDevice {
    fn drop(&mut self) {
        SHARES.set(self.before);
    }
}

/// The device that this thread takes instead of a new one, unless it had an error.
pub(super) fn shared() -> Option<Gpu> {
    if !SHARES.get() {
        return None;
    }
    let shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    shared.clone().filter(|gpu| gpu.faults().check().is_ok())
}

/// Lets other threads take a new device, if this thread shares.
pub(super) fn share(gpu: &Gpu) {
    if SHARES.get() {
        *SHARED.lock().unwrap_or_else(PoisonError::into_inner) = Some(gpu.clone());
    }
}
