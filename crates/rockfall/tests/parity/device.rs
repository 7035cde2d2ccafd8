//! Running stages on the GPU.

use std::sync::LazyLock;

use rockfall::exec::gpu::{Gpu, GpuWorld, block_on};
use rockfall::model::buffer::Buffer;
use rockfall::model::world::World;
use rockfall::step::schedule::Run;

/// A test without an adapter fails: skipped it would prove nothing.
pub(crate) fn open() -> Gpu {
    Gpu::open_blocking(true).expect("these tests need a Vulkan driver, lavapipe will do")
}

pub(crate) static GPU: LazyLock<Gpu> = LazyLock::new(open);

/// What stages make of a world on the GPU: every buffer up, the stages, every buffer down.
pub(crate) fn on_gpu(gpu: &Gpu, before: &World, runs: &[Run]) -> World {
    let mut device = GpuWorld::new(gpu, before).unwrap();
    for buffer in Buffer::ALL {
        device.upload_buffer(before, buffer).unwrap();
    }
    device.run(runs, &before.step, 1).unwrap();
    // Nothing of what comes back may be what was there before.
    let mut after = before.clone();
    let vectors = [&mut after.wrenches, &mut after.orientations, &mut after.extents];
    for buffer in after.states.iter_mut().chain(vectors) {
        buffer.fill(glam::Vec4::NAN);
    }
    after.aabbs.fill(bytemuck::Zeroable::zeroed());
    after.lists.fill(u32::MAX);
    after.topology.fill(u32::MAX);
    after.cells.fill(u32::MAX);
    after.dispatch_sizes.fill(u32::MAX);
    block_on(gpu.device(), device.download(&mut after, &Buffer::ALL)).unwrap();
    after
}
