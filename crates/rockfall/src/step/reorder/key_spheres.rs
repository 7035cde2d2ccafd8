//! Memory order, 1 of 5: computes the sort key of every sphere.
//!
//! The key holds the size class of the sphere in its highest two bits. The
//! other 30 bits are the place of the sphere on a Z-order curve through cells of the grid's size (Morton 1966), with ten bits per axis. Beyond 1,024 cells the curve begins
//! again. Then spheres that are far apart may get neighbouring places, which affects speed only. The stage leaves pairs of
//! key and memory slot in `Y2`.

use bytemuck::cast_slice_mut;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::model::world::order::{size_class, spread};
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "key_spheres",
    wgsl: Wgsl::File(part!("step/reorder/key_spheres.wgsl")),
    bindings: &[read("state", Buffer::Start), write("pairs", Buffer::Y2), read("status", Buffer::Status)],
    threads: Threads::Spheres,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: key_spheres,
};

fn key_spheres(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let n = world.step.layout.spheres;
    let [start, y2, ..] = &mut world.states;
    let pairs: &mut [[u32; 2]] = cast_slice_mut(y2);
    for ((position, slot), pair) in start.iter().zip(0..n).zip(pairs) {
        let cell = |x: f32| ((x / world.step.layout.cell_size).floor() as i32).clamp(-(1 << 30), 1 << 30);
        let axes = position.truncate().to_array().map(|x| spread(cell(x) as u64 & 0x3ff) as u32);
        let class = size_class(position.w, world.step.layout.cell_size);
        *pair = [axes[0] | axes[1] << 1 | axes[2] << 2 | class << 30, slot];
    }
}
