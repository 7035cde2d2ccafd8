//! Devices with limits of a test's choice.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// What wgpu gives at once on native targets.
fn ready<T>(future: impl Future<Output = T>) -> T {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => value,
        Poll::Pending => panic!("it does not wait"),
    }
}

/// A device of the first Vulkan adapter with limits of the test's choice.
pub(crate) fn device(change: impl FnOnce(&mut wgpu::Limits)) -> (wgpu::Device, wgpu::Queue) {
    let adapters = ready(rockfall::exec::gpu::instance().enumerate_adapters(wgpu::Backends::VULKAN));
    let adapter = adapters.first().expect("these tests need a Vulkan driver, lavapipe will do");
    let mut required_limits = adapter.limits();
    change(&mut required_limits);
    let (device, queue) =
        ready(adapter.request_device(&wgpu::DeviceDescriptor { required_limits, ..Default::default() })).expect("a device");
    // wgpu panics where nobody hears of an error.
    device.on_uncaptured_error(std::sync::Arc::new(|error| println!("told to nobody: {error}")));
    (device, queue)
}
