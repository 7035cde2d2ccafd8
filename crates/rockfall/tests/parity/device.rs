//! Runs stages on the GPU.

use std::sync::LazyLock;

use rockfall::exec::gpu::{Gpu, GpuWorld, block_on};
use rockfall::model::buffer::Buffer;
use rockfall::model::world::World;
use rockfall::step::schedule::Run;

/// Opens a GPU. Without an adapter the test fails, because a skipped test proves nothing.
pub(crate) fn open() -> Gpu {
    Gpu::open_blocking(true).expect("these tests need a Vulkan driver; lavapipe is enough")
}

pub(crate) static GPU: LazyLock<Gpu> = LazyLock::new(open);

/// Uploads every buffer of a world, runs stages on the GPU, downloads every buffer, and returns the resulting world.
pub(crate) fn on_gpu(gpu: &Gpu, before: &World, runs: &[Run]) -> World {
    let mut device = GpuWorld::new(gpu, before).unwrap();
    for buffer in Buffer::ALL {
        device.upload_buffer(before, buffer).unwrap();
    }
    device.run(runs, &before.step, 1).unwrap();
    // Overwrite everything, so that a word that is not downloaded shows as a difference.
    let mut after = before.clone();
    let vectors = [&mut after.wrenches, &mut after.orientations, &mut after.extents];
    for buffer in after.states.iter_mut().chain(vectors) {
        buffer.fill(glam::Vec4::NAN);
    }
    after.rates.fill(f32::NAN);
    after.aabbs.fill(bytemuck::Zeroable::zeroed());
    after.lists.fill(u32::MAX);
    after.topology.fill(u32::MAX);
    after.cells.fill(u32::MAX);
    block_on(gpu.device(), device.download(&mut after, &Buffer::ALL)).unwrap();
    after
}
