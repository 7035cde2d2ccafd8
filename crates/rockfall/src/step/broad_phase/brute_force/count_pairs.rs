//! Broad phase, 1 of 3: how many entries the list of every mover has.
//!
//! The tiled N² test of the thesis (section 2.5.1): a workgroup loads a tile of AABBs, every thread tests its own mover
//! against it. What may meet: AABBs overlap (touching counts), groups (low 16 bits of the tags) equal, not itself, not
//! rod and polygon. A rod has `BOX_FEATURES` entries for a box. Exact: only stored floats are compared, so `fill_pairs`
//! decides the same.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::world::World;
use crate::step::broad_phase::meet::for_each_pair;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_pairs",
    wgsl: Wgsl::File(part!("step/broad_phase/brute_force/count_pairs.wgsl")),
    bindings: &[read("aabbs", Buffer::Aabbs), write("lists", Buffer::Lists), read("status", Buffer::Status)],
    threads: Threads::Movers,
    cpu: count_pairs,
};

fn count_pairs(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 {
        return;
    }
    let (step, aabbs) = (&world.step, &world.aabbs);
    let movers = world.step.spheres + world.step.rods;
    let (counts, padding) = world.lists[..step.slices_at as usize].split_at_mut(movers as usize);
    counts.par_iter_mut().enumerate().with_min_len(GRAIN).for_each(|(mover, count)| {
        *count = 0;
        for_each_pair(step, aabbs, mover as u32, |_| *count += 1);
    });
    padding.fill(0);
}
