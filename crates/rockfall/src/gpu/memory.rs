//! What a world's buffers are on the device: sizes and limits.

use crate::error::{Error, Result};
use crate::gpu::fault::catch;
use crate::stage::Buffer;
use crate::world::World;

/// No buffer is smaller: WebGPU refuses to bind what is empty.
const LEAST_BYTES: u64 = 16;

/// Bytes that the kernels address in a buffer, from the counts and offsets alone: a hand-made world may hold less.
pub(crate) fn bytes_needed(world: &World, buffer: Buffer) -> u64 {
    let step = &world.step;
    let vectors = |count: u64| 16 * count;
    let addressed = match buffer {
        Buffer::Start | Buffer::Y2 | Buffer::Y3 | Buffer::Y4 => vectors(3 * u64::from(step.spheres)),
        Buffer::Aabbs => 32 * u64::from(world.objects()),
        Buffer::Words | Buffer::Status => 0,
        Buffer::Cells => 4 * (u64::from(step.sorted_at) + u64::from(world.objects())),
        Buffer::Lists => 4 * (u64::from(step.entries_at) + u64::from(step.pair_capacity)),
        Buffer::Extents => vectors(u64::from(world.objects())),
        Buffer::Wrenches => vectors(4 * u64::from(step.rods)),
        Buffer::Orientations => vectors(u64::from(step.spheres)),
    };
    addressed.max(world.bytes(buffer).len() as u64).max(LEAST_BYTES)
}

/// # Errors
/// [`Error::DeviceLimit`] for a buffer that the device cannot bind or allocate.
pub(crate) fn check_size(device: &wgpu::Device, what: &'static str, needed: u64) -> Result<()> {
    let limits = device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if needed > limit {
        return Err(Error::DeviceLimit { what, needed, limit });
    }
    Ok(())
}

pub(crate) fn make_buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer> {
    catch(device, || {
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    })
}

pub(crate) fn make_storage(device: &wgpu::Device, buffer: Buffer, size: u64) -> Result<wgpu::Buffer> {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    make_buffer(device, buffer.label(), size, usage)
}
