//! What a world's arrays are on the device: sizes, chunks and limits.

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::model::buffer::Buffer;
use crate::model::layout::COLLISION_WORDS;
use crate::model::world::World;
use crate::step::catalog::ALL;
use crate::step::fused::run_steps::{STAGE as RUN_STEPS, is_small};
use crate::step::stage::Stage;

/// No buffer is smaller: WebGPU refuses to bind what holds no element.
const LEAST_BYTES: u64 = ELEMENT_BYTES;
/// The largest element of an array, a row of the pair lists: chunks hold whole ones.
const ELEMENT_BYTES: u64 = 128;

/// Bytes that the kernels address in a buffer, from the counts and offsets alone: a hand-made world may hold less.
pub(crate) fn bytes_needed(world: &World, buffer: Buffer) -> u64 {
    let step = &world.step;
    let vectors = |count: u64| 16 * count;
    let addressed = match buffer {
        Buffer::Start | Buffer::Y2 | Buffer::Y3 | Buffer::Y4 => vectors(3 * u64::from(step.spheres)),
        Buffer::States if is_small(step) => vectors(12 * u64::from(step.spheres)),
        Buffer::Aabbs => 32 * u64::from(world.objects()),
        Buffer::States | Buffer::Topology | Buffer::DispatchSizes | Buffer::Status => 0,
        Buffer::Cells => 4 * world.cell_words(),
        Buffer::Lists => 4 * world.list_words(),
        Buffer::CollisionIndices => 4 * world.slot_words(),
        Buffer::Collisions => 4 * u64::from(COLLISION_WORDS) * u64::from(step.collision_room),
        // Rows are read four at a time.
        Buffer::Extents => vectors(u64::from(world.objects()) + 3),
        Buffer::Wrenches => vectors(4 * u64::from(step.rods)),
        Buffer::Orientations => vectors(u64::from(step.spheres)),
    };
    addressed.max(world.bytes(buffer).len() as u64).max(LEAST_BYTES)
}

/// Bytes of the chunks of an array that is larger than a binding may be.
pub(crate) fn chunk_bytes(limits: &wgpu::Limits) -> u64 {
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    (most - most % ELEMENT_BYTES).max(ELEMENT_BYTES)
}

/// Whether every stage can bind arrays of these sizes. One that is larger than a binding may be takes several.
///
/// # Errors
/// [`Error::DeviceLimit`] for the array that takes the most bindings in a stage that has too many.
pub(crate) fn check_sizes(limits: &wgpu::Limits, needed: impl Fn(Buffer) -> u64) -> Result<()> {
    let chunk = chunk_bytes(limits);
    let most = u64::from(limits.max_storage_buffers_per_shader_stage);
    let excess =
        |stage: &Stage| stage_buffers(stage).map(|buffer| needed(buffer).div_ceil(chunk)).sum::<u64>().saturating_sub(most);
    // `run_steps` stands for others, and is left out where its arrays do not fit one binding each.
    let needed_stages = ALL.into_iter().filter(|stage| stage.name != RUN_STEPS.name);
    let Some(worst) = needed_stages.max_by_key(|stage| excess(stage)) else { return Ok(()) };
    let excess = excess(worst);
    let largest = stage_buffers(worst).max_by_key(|buffer| needed(*buffer));
    match largest {
        Some(buffer) if excess > 0 => {
            let chunks = needed(buffer).div_ceil(chunk).saturating_sub(excess).max(1);
            Err(Error::DeviceLimit { what: buffer.label(), needed: needed(buffer), limit: chunks * chunk })
        }
        _ => Ok(()),
    }
}

/// The buffers that a stage binds; in every pass they are as large.
fn stage_buffers(stage: &Stage) -> impl Iterator<Item = Buffer> {
    stage.bindings.iter().map(|binding| binding.slot.buffer(0))
}

/// Of a buffer that the host reads.
pub(crate) const READ_BACK: wgpu::BufferUsages = wgpu::BufferUsages::MAP_READ.union(wgpu::BufferUsages::COPY_DST);

pub(crate) fn make_buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer> {
    catch(device, || {
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(binding: u64, buffers: u32) -> wgpu::Limits {
        wgpu::Limits {
            max_storage_buffer_binding_size: binding,
            max_storage_buffers_per_shader_stage: buffers,
            max_buffer_size: 1 << 32,
            ..Default::default()
        }
    }

    #[test]
    fn chunks_hold_whole_elements() {
        assert_eq!(chunk_bytes(&limits((1 << 31) - 4, 8)), (1 << 31) - 128);
        assert_eq!(chunk_bytes(&limits(300, 8)), 256);
        assert_eq!(chunk_bytes(&wgpu::Limits { max_buffer_size: 128, ..limits(300, 8) }), 128);
    }

    /// `advance` binds eight arrays, three of them states.
    #[test]
    fn what_a_stage_cannot_bind_is_refused() {
        let sizes = |large: u64| move |buffer: Buffer| if buffer == Buffer::Lists { large } else { 16 };
        assert!(check_sizes(&limits(1024, 8), sizes(1024)).is_ok());
        let refused = check_sizes(&limits(1024, 8), sizes(1025));
        assert!(
            matches!(refused, Err(Error::DeviceLimit { what: "the pair lists", needed: 1025, limit: 1024 })),
            "{refused:?}"
        );
        assert!(check_sizes(&limits(1024, 11), sizes(4096)).is_ok());
        let refused = check_sizes(&limits(1024, 11), sizes(5000));
        assert!(matches!(refused, Err(Error::DeviceLimit { needed: 5000, limit: 4096, .. })), "{refused:?}");
    }
}
