//! What a world's buffers are on the host and on the device: bytes, sizes, names.

use bytemuck::{bytes_of, bytes_of_mut, cast_slice, cast_slice_mut};

use crate::error::{Error, Result};
use crate::gpu::fault::catch;
use crate::stage::Buffer;
use crate::world::World;

/// No buffer is smaller: WebGPU refuses to bind what is empty.
const LEAST_BYTES: u64 = 16;

/// The host's array of a buffer.
pub(crate) fn bytes(world: &World, buffer: Buffer) -> &[u8] {
    match buffer {
        Buffer::Start => cast_slice(&world.states[0]),
        Buffer::Y2 => cast_slice(&world.states[1]),
        Buffer::Y3 => cast_slice(&world.states[2]),
        Buffer::Y4 => cast_slice(&world.states[3]),
        Buffer::Aabbs => cast_slice(&world.aabbs),
        Buffer::Words => cast_slice(&world.words),
        Buffer::Cells => cast_slice(&world.cells),
        Buffer::Extents => cast_slice(&world.extents),
        Buffer::Lists => cast_slice(&world.lists),
        Buffer::Weights => cast_slice(&world.weights),
        Buffer::Wrenches => cast_slice(&world.wrenches),
        Buffer::Orientations => cast_slice(&world.orientations),
        Buffer::Status => bytes_of(&world.status),
    }
}

pub(crate) fn bytes_mut(world: &mut World, buffer: Buffer) -> &mut [u8] {
    match buffer {
        Buffer::Start => cast_slice_mut(&mut world.states[0]),
        Buffer::Y2 => cast_slice_mut(&mut world.states[1]),
        Buffer::Y3 => cast_slice_mut(&mut world.states[2]),
        Buffer::Y4 => cast_slice_mut(&mut world.states[3]),
        Buffer::Aabbs => cast_slice_mut(&mut world.aabbs),
        Buffer::Words => cast_slice_mut(&mut world.words),
        Buffer::Cells => cast_slice_mut(&mut world.cells),
        Buffer::Extents => cast_slice_mut(&mut world.extents),
        Buffer::Lists => cast_slice_mut(&mut world.lists),
        Buffer::Weights => cast_slice_mut(&mut world.weights),
        Buffer::Wrenches => cast_slice_mut(&mut world.wrenches),
        Buffer::Orientations => cast_slice_mut(&mut world.orientations),
        Buffer::Status => bytes_of_mut(&mut world.status),
    }
}

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
        Buffer::Weights => 4 * u64::from(step.pair_capacity),
        Buffer::Extents => vectors(u64::from(world.objects())),
        Buffer::Wrenches => vectors(4 * u64::from(step.rods)),
        Buffer::Orientations => vectors(u64::from(step.spheres)),
    };
    addressed.max(bytes(world, buffer).len() as u64).max(LEAST_BYTES)
}

pub(crate) fn name(buffer: Buffer) -> &'static str {
    match buffer {
        Buffer::Start => "the state",
        Buffer::Y2 => "stage state 2",
        Buffer::Y3 => "stage state 3",
        Buffer::Y4 => "stage state 4",
        Buffer::Aabbs => "the AABBs",
        Buffer::Words => "topology and static objects",
        Buffer::Cells => "the grid",
        Buffer::Extents => "the extents of sorted objects",
        Buffer::Lists => "the pair lists",
        Buffer::Weights => "the collision weights",
        Buffer::Wrenches => "the forces on rods",
        Buffer::Orientations => "the orientations",
        Buffer::Status => "the status",
    }
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
    make_buffer(device, name(buffer), size, usage)
}
