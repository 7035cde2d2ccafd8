//! What goes wrong on a device: kept until somebody asks, and never a panic.

use std::future::Future;
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use crate::error::{Error, Result};

/// The first thing that went wrong on a device outside of any call that could have returned it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faults {
    first: Arc<Mutex<Option<String>>>,
}

impl Faults {
    pub(crate) fn record(&self, text: String) {
        let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(text);
    }

    /// # Errors
    /// [`Error::Device`] once something went wrong; it stays so, for what the buffers hold cannot be trusted any more.
    pub(crate) fn check(&self) -> Result<()> {
        match &*self.first.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(text) => Err(Error::Device(text.clone())),
            None => Ok(()),
        }
    }

    /// Has errors that no scope catches, and the loss of the device, recorded here.
    pub(crate) fn watch(&self, device: &wgpu::Device) {
        let faults = self.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| faults.record(describe(&error))));
        let faults = self.clone();
        device.set_device_lost_callback(move |reason, message| {
            faults.record(lost(&format!("{reason:?}: {message}")));
        });
    }
}

fn describe(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::OutOfMemory { .. } => {
            "out of memory; use fewer objects, close other programs, or take --backend cpu".to_owned()
        }
        other => match other.to_string() {
            // A lost device makes invalid objects without a word, and wgpu complains of the first use of one.
            text if text.contains("device is lost") || text.contains("label is invalid") => lost(text.trim()),
            text => text,
        },
    }
}

/// What is told of a device that is no more.
pub(crate) fn lost(why: &str) -> String {
    format!(
        "the device was lost ({why}); its driver was reset or removed, or ran out of time or memory: run again, with fewer \
         objects if it happens again, or take --backend cpu"
    )
}

/// Runs `work`, and gives what the device had to say about it.
///
/// # Errors
/// [`Error::Device`] with what was wrong. In a browser the answer comes too late for this; it is on the console.
pub fn catch<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T> {
    let scopes = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal]
        .map(|filter| device.push_error_scope(filter));
    let done = work();
    let mut first = None;
    // Scopes are popped in reverse.
    for scope in scopes.into_iter().rev() {
        let error = pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop()));
        if let Poll::Ready(Some(error)) = error {
            first.get_or_insert(describe(&error));
        }
    }
    match first {
        Some(text) => Err(Error::Device(text)),
        None => Ok(done),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_says_what_to_do() {
        let of = |text: &str| -> Box<dyn std::error::Error + Send + Sync> { text.into() };
        let memory = describe(&wgpu::Error::OutOfMemory { source: of("no memory") });
        assert!(memory.contains("fewer objects") && memory.contains("--backend cpu"), "{memory}");
        let description = "Buffer with 'x' label is invalid".to_owned();
        let invalid = describe(&wgpu::Error::Validation { source: of("x"), description: description.clone() });
        assert!(invalid.contains(&description) && invalid.contains("--backend cpu"), "{invalid}");
        // What is wrong with a kernel is told as it is.
        let description = "a kernel".to_owned();
        assert_eq!(describe(&wgpu::Error::Validation { source: of("x"), description: description.clone() }), description);
    }
}
