//! Faults of a device: recorded until they are checked, and never a panic.

#[cfg(not(target_family = "wasm"))]
use std::future::Future;
#[cfg(not(target_family = "wasm"))]
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
#[cfg(not(target_family = "wasm"))]
use std::task::{Context, Poll, Waker};

use crate::error::{Error, Result};

/// The first fault of a device that no call could return as an error.
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
    /// [`Error::Device`] once a fault was recorded, and from then on always, because the contents of the buffers can no longer
    /// be trusted.
    pub(crate) fn check(&self) -> Result<()> {
        match &*self.first.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(text) => Err(Error::Device(text.clone())),
            None => Ok(()),
        }
    }

    /// Records the loss of the device, and errors that no error scope catches.
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
            // A lost device creates invalid objects without an error. wgpu reports an error at the first use of one.
            text if text.contains("device is lost") || text.contains("label is invalid") => lost(text.trim()),
            text => text,
        },
    }
}

/// Message for a lost device.
pub(crate) fn lost(why: &str) -> String {
    format!(
        "the device was lost ({why}); its driver was reset or removed, or ran out of time or memory: run again, with fewer \
         objects if it happens again, or use --backend cpu"
    )
}

/// Runs `work` and returns its result, or the error that the device reported meanwhile.
///
/// # Errors
/// [`Error::Device`] with the first error.
#[cfg(not(target_family = "wasm"))]
pub fn catch<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T> {
    let scopes = [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Internal]
        .map(|filter| device.push_error_scope(filter));
    let done = work();
    let mut first = None;
    // Scopes are popped in reverse order.
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

/// Runs `work` and returns its result. In a browser the device reports errors too late for this function. It reports them to
/// the handler of the device: [`Faults`] returns them from the next call that waits, or they appear on the console.
///
/// # Errors
/// None.
#[cfg(target_family = "wasm")]
pub fn catch<T>(_device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T> {
    Ok(work())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_what_to_do() {
        let of = |text: &str| -> Box<dyn std::error::Error + Send + Sync> { text.into() };
        let memory = describe(&wgpu::Error::OutOfMemory { source: of("no memory") });
        assert!(memory.contains("fewer objects") && memory.contains("--backend cpu"), "{memory}");
        let description = "Buffer with 'x' label is invalid".to_owned();
        let invalid = describe(&wgpu::Error::Validation { source: of("x"), description: description.clone() });
        assert!(invalid.contains(&description) && invalid.contains("--backend cpu"), "{invalid}");
        // Errors in a kernel are reported unchanged.
        let description = "a kernel".to_owned();
        assert_eq!(describe(&wgpu::Error::Validation { source: of("x"), description: description.clone() }), description);
    }
}
