//! Reading a buffer of the device back to the host.

use rockfall::{Error, Result, wgpu};

/// Waits for the device, maps a buffer, and returns what `read` makes of its bytes.
pub(crate) fn read_back<T>(device: &wgpu::Device, staging: &wgpu::Buffer, read: impl FnOnce(&[u8]) -> T) -> Result<T> {
    let failed = |why: &dyn std::fmt::Display| Error::Device(format!("a buffer could not be read back: {why}"));
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |done| {
        // The receiver is gone only if the wait below failed, which returns an error of its own.
        let _ = sender.send(done);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(&error))?;
    receiver.recv().map_err(|error| failed(&error))?.map_err(|error| failed(&error))?;
    let view = staging.get_mapped_range(..).map_err(|error| failed(&error))?;
    let value = read(&view);
    drop(view);
    staging.unmap();
    Ok(value)
}
