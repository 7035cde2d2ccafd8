//! Memory order, 1 of 5: the size of every sphere, and its place on a Z-order curve through cells of the grid's size (Morton 1966).
//!
//! Ten binary digits an axis: beyond 1,024 cells the curve begins again, which costs nothing but nearness. Leaves pairs of key
//! and memory slot in `Y2`.

use bytemuck::cast_slice_mut;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::model::world::order::{size_class, spread};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "key_spheres",
    wgsl: Wgsl::File(part!("step/reorder/key_spheres.wgsl")),
    bindings: &[read("state", Buffer::Start), write("pairs", Buffer::Y2), read("status", Buffer::Status)],
    threads: Threads::Spheres,
    cpu: key_spheres,
};

fn key_spheres(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let n = world.step.spheres;
    let [start, y2, ..] = &mut world.states;
    let pairs: &mut [[u32; 2]] = cast_slice_mut(y2);
    for ((position, slot), pair) in start.iter().zip(0..n).zip(pairs) {
        let cell = |x: f32| ((x / world.step.cell_size).floor() as i32).clamp(-(1 << 30), 1 << 30);
        let axes = position.truncate().to_array().map(|x| spread(cell(x) as u64 & 0x3ff) as u32);
        *pair = [axes[0] | axes[1] << 1 | axes[2] << 2 | size_class(position.w, world.step.cell_size) << 30, slot];
    }
}
