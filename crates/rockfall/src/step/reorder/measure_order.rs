//! Measures how close spheres that are neighbours in space are in memory.
//!
//! For about [`ORDER_SAMPLE`] spheres the stage adds up the number of binary digits of the distance in memory to every sphere
//! in the list. In perfect order most neighbours share a few cache lines. In random order they are anywhere, and every
//! additional digit makes it more likely that a read has to wait for memory.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::ORDER_SAMPLE;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "measure_order",
    wgsl: Wgsl::File(part!("step/reorder/measure_order.wgsl")),
    bindings: &[read("lists", Buffer::Lists), write("status", Buffer::Status)],
    threads: Threads::Spheres,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: measure_order,
};

fn measure_order(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let spheres = world.step.layout.spheres;
    let lists = Lists::new(&world.step, &world.lists);
    for slot in (0..spheres).step_by(1 + (spheres / ORDER_SAMPLE) as usize) {
        for other in lists.row(slot).map(|entry| entry.id()).filter(|id| *id < spheres) {
            world.status.order_entries += 1;
            world.status.order_digits += u32::BITS - slot.abs_diff(other).leading_zeros();
        }
    }
}
