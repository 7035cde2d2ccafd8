//! The arrays of a world on the device: sizes, chunks and limits.

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::model::buffer::Buffer;
use crate::model::layout::{COLLISION_WORDS, POSE_FLOATS};
use crate::model::world::World;
use crate::model::world::walls::pose_rows;
use crate::step::catalog::ALL;
use crate::step::stage::Stage;

/// Smallest size of a buffer, in bytes: WebGPU refuses to bind a buffer that holds no element.
const LEAST_BYTES: u64 = ELEMENT_BYTES;
/// Size of the largest array element, a row of the pair lists, in bytes. Chunks hold whole elements.
const ELEMENT_BYTES: u64 = 128;
/// Steps that a table of poses has room for from the start. It grows where more are under way at a time.
const POSE_STEPS: u32 = 40;

/// Number of bytes that the kernels address in a buffer, from the counts and offsets alone. The array of a hand-made world may
/// be shorter.
pub(crate) fn bytes_needed(world: &World, buffer: Buffer) -> u64 {
    let step = &world.step;
    let vectors = |count: u64| 16 * count;
    let addressed = match buffer {
        Buffer::Start => vectors(world.rows_of_state(0) as u64),
        Buffer::Y2 => vectors(world.rows_of_state(1) as u64),
        Buffer::Y3 => vectors(world.rows_of_state(2) as u64),
        Buffer::Y4 => vectors(world.rows_of_state(3) as u64),
        Buffer::Aabbs => 32 * u64::from(world.objects()),
        // The host's arrays of these are complete.
        Buffer::Poses => 4 * u64::from(pose_rows(POSE_STEPS) * step.layout.bodies * POSE_FLOATS),
        Buffer::Topology | Buffer::Histories | Buffer::Rates | Buffer::RigidBodies | Buffer::Servos | Buffer::Status => 0,
        Buffer::Cells => 4 * world.cell_words(),
        Buffer::Lists => 4 * world.list_words(),
        Buffer::CollisionIndices => 4 * world.collision_index_words(),
        Buffer::Collisions => 4 * u64::from(COLLISION_WORDS) * u64::from(step.layout.collision_room),
        // Rows are read four at a time, so there is room for three more.
        Buffer::Extents => vectors(u64::from(world.objects()) + 3),
        Buffer::Wrenches => vectors(world.wrench_count() as u64),
        Buffer::ServoLoads => 8 * world.servo_load_count() as u64,
        Buffer::Orientations => vectors(u64::from(step.layout.spheres)),
    };
    addressed.max(world.bytes(buffer).len() as u64).max(LEAST_BYTES)
}

/// Chunk size in bytes for an array that is larger than the device's limit for one binding.
pub(crate) fn chunk_bytes(limits: &wgpu::Limits) -> u64 {
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    (most - most % ELEMENT_BYTES).max(ELEMENT_BYTES)
}

/// Checks that every stage can bind arrays of these sizes. An array larger than the limit for one binding takes several
/// bindings.
///
/// # Errors
/// [`Error::DeviceLimit`] if a stage needs too many bindings. It names the array that takes the most bindings in the worst such
/// stage.
pub(crate) fn check_sizes(limits: &wgpu::Limits, needed: impl Fn(Buffer) -> u64) -> Result<()> {
    let chunk = chunk_bytes(limits);
    let most = u64::from(limits.max_storage_buffers_per_shader_stage);
    let excess =
        |stage: &Stage| stage_buffers(stage).map(|buffer| needed(buffer).div_ceil(chunk)).sum::<u64>().saturating_sub(most);
    let Some(worst) = ALL.into_iter().max_by_key(|stage| excess(stage)) else { return Ok(()) };
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

/// The buffers that a stage binds in pass 0. Other passes bind buffers of the same sizes.
fn stage_buffers(stage: &Stage) -> impl Iterator<Item = Buffer> {
    stage.bindings.iter().map(|binding| binding.slot.buffer(0))
}

/// Usage of a uniform block.
pub(super) const UNIFORM: wgpu::BufferUsages = wgpu::BufferUsages::UNIFORM.union(wgpu::BufferUsages::COPY_DST);
/// Usage of a buffer that the host reads.
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
    fn arrays_that_need_too_many_bindings_are_refused() {
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
