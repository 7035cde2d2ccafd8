//! Processes that were forked. A fork copies memory, but of all threads only the one that forks: the threads of rayon and of
//! graphics drivers are missing in the child, which would wait for them for ever.
//!
//! In a child, work on the CPU runs in threads of its own ([`detached`]). The GPU cannot be used there once the parent has used it.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::SimulationError;

/// Number of forks between the process that imported the module and this one.
static GENERATION: AtomicU32 = AtomicU32::new(0);
/// Whether this process or one that it was forked from has used a graphics adapter.
static OPENED: AtomicBool = AtomicBool::new(false);
/// Whether a process that this one was forked from has used a graphics adapter.
static LOST: AtomicBool = AtomicBool::new(false);
/// The threads of a forked process, with its generation.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Python calls it in the child after a fork.
#[pyfunction]
pub(crate) fn forked() {
    GENERATION.fetch_add(1, Ordering::Relaxed);
    LOST.store(OPENED.load(Ordering::Relaxed), Ordering::Relaxed);
}

fn generation() -> u32 {
    GENERATION.load(Ordering::Relaxed)
}

/// The threads of a forked process. `None` in the process that imported the module, which has those of rayon.
fn pool() -> Option<Arc<ThreadPool>> {
    let generation = generation();
    if generation == 0 {
        return None;
    }
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if pool.as_ref().is_none_or(|(of, _)| *of != generation) {
        // That of the parent has no threads here.
        std::mem::forget(pool.take());
        *pool = ThreadPoolBuilder::new().build().ok().map(|made| (generation, Arc::new(made)));
    }
    pool.as_ref().map(|(_, pool)| Arc::clone(pool))
}

/// Calls a function without the GIL. In a forked process it runs in threads of that process.
pub(crate) fn detached<R: Send>(py: Python<'_>, call: impl FnOnce() -> R + Send) -> R {
    py.detach(|| match pool() {
        Some(pool) => pool.install(call),
        None => call(),
    })
}

fn lost() -> PyErr {
    SimulationError::new_err(
        "this process was forked from one that had used the GPU, so it cannot use the GPU: start processes with \"spawn\" \
         (multiprocessing.get_context(\"spawn\"); in Gymnasium, vector_kwargs={\"context\": \"spawn\"}), or use backend=\"cpu\"",
    )
}

/// An error in a process that cannot use graphics adapters because of a fork.
pub(crate) fn check_graphics() -> PyResult<()> {
    if LOST.load(Ordering::Relaxed) { Err(lost()) } else { Ok(()) }
}

/// Notes that this process uses a graphics adapter.
pub(crate) fn graphics_opened() {
    OPENED.store(true, Ordering::Relaxed);
}

/// A value that may need threads to be dropped. It is not dropped in processes that were forked after it was made.
#[derive(Debug)]
pub(crate) struct Owned<T> {
    value: Option<T>,
    generation: u32,
}

impl<T> Owned<T> {
    pub(crate) fn new(value: T) -> Self {
        Self { value: Some(value), generation: generation() }
    }

    /// The value, unless it was made before this process was forked.
    pub(crate) fn into_own(mut self) -> Option<T> {
        if self.is_inherited() { None } else { self.value.take() }
    }

    pub(crate) fn is_inherited(&self) -> bool {
        self.generation != generation()
    }

    /// An error if the value needs a GPU and was made before this process was forked.
    pub(crate) fn check(&self, needs_gpu: bool) -> PyResult<()> {
        if needs_gpu && self.is_inherited() { Err(lost()) } else { Ok(()) }
    }
}

impl<T> Deref for Owned<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().expect("there is a value until it is dropped")
    }
}

impl<T> DerefMut for Owned<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().expect("there is a value until it is dropped")
    }
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        if self.is_inherited() {
            std::mem::forget(self.value.take());
        }
    }
}
