//! Grid broad phase, 9 of 9: every list in ascending order of id, then feature, each entry once. Does nothing in a void
//! step.

use rayon::prelude::*;

use crate::cpu::lists::{Lists, slot};
use crate::layout::{ENTRY_FEATURE_MASK, ENTRY_ID_BITS, ENTRY_ID_MASK};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "order_pairs",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/order_pairs.wgsl")],
    bindings: &[write("lists", Buffer::Lists), read("status", Buffer::Status)],
    threads: Threads::Movers,
    cpu: order_pairs,
};

fn order_pairs(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    let lists = Lists::new(&world.step, &world.lists);
    let ordered: Vec<Vec<u32>> = (0..world.step.spheres + world.step.rods)
        .into_par_iter()
        .map(|mover| {
            let mut entries: Vec<u32> = lists.row(mover).map(|entry| entry.word).collect();
            entries.sort_unstable_by_key(|entry| (entry & ENTRY_ID_MASK, entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK));
            entries.dedup();
            entries
        })
        .collect();
    for (mover, entries) in (0..).zip(ordered) {
        world.lists[mover as usize] = entries.len() as u32;
        for (place, entry) in (0..).zip(entries) {
            let slot = slot(&world.step, &world.lists, mover, place);
            world.lists[(world.step.entries_at + slot) as usize] = entry;
        }
    }
}
