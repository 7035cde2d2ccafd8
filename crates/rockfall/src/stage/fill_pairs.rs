//! Broad phase, 3 of 3: the entries, in ascending order of id, then feature. Does nothing in a void step.

use rayon::prelude::*;

use crate::cpu::broad::for_each_pair;
use crate::layout::SLICE;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_pairs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/pair_tiles.wgsl"),
        part!("stage/fill_pairs.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("lists", Buffer::Lists),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: fill_pairs,
};

fn fill_pairs(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    let (step, aabbs) = (&world.step, &world.aabbs);
    let movers = step.spheres + step.rods;
    let (index, entries) = world.lists.split_at_mut(step.entries_at as usize);
    let offsets = &index[step.slices_at as usize..];
    // Slices lie one behind the other, so each can be handed to a thread of its own.
    let mut rest = entries;
    let slices: Vec<&mut [u32]> = offsets
        .windows(2)
        .map(|bounds| rest.split_off_mut(..(bounds[1] - bounds[0]) as usize).unwrap_or_default())
        .collect();
    slices.into_par_iter().enumerate().for_each(|(slice, entries)| {
        let first = slice as u32 * SLICE;
        for mover in first..movers.min(first + SLICE) {
            let mut at = (mover - first) as usize;
            for_each_pair(step, aabbs, mover, |word| {
                entries[at] = word;
                at += SLICE as usize;
            });
        }
    });
}
