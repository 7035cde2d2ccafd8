//! Broad phase, 3 of 3: the entries, in ascending order of id, then feature. Does nothing in a void step.

use crate::cpu::broad::for_each_pair;
use crate::cpu::lists::fill_slices;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_pairs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/meet.wgsl"),
        part!("wgsl/pair_tiles.wgsl"),
        part!("stage/fill_pairs.wgsl"),
    ],
    bindings: &[read("aabbs", Buffer::Aabbs), write("lists", Buffer::Lists), read("status", Buffer::Status)],
    threads: Threads::Movers,
    cpu: fill_pairs,
};

fn fill_pairs(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.rebuild == 0 {
        return;
    }
    let (step, aabbs) = (&world.step, &world.aabbs);
    fill_slices(step, &mut world.lists, |mover, take| for_each_pair(step, aabbs, mover, take));
}
