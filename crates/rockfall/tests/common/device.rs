//! Devices with limits that a test chooses.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Returns the value of a future that is ready at once, as wgpu's futures are on native targets.
fn ready<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("the future must be ready at once"),
    }
}

/// A device of the first Vulkan adapter with limits that the test changes.
pub(crate) fn device(change: impl FnOnce(&mut wgpu::Limits)) -> (wgpu::Device, wgpu::Queue) {
    let adapters = ready(rockfall::exec::gpu::instance().enumerate_adapters(wgpu::Backends::VULKAN));
    let adapter = adapters.first().expect("these tests need a Vulkan driver such as lavapipe");
    let mut required_limits = adapter.limits();
    change(&mut required_limits);
    let (device, queue) =
        ready(adapter.request_device(&wgpu::DeviceDescriptor { required_limits, ..Default::default() })).expect("a device");
    // Without a handler, wgpu panics on an error.
    device.on_uncaptured_error(std::sync::Arc::new(|error| println!("uncaptured wgpu error: {error}")));
    (device, queue)
}
