//! Broad phase, 1 of 3: counts the entries in the list of every mover.
//!
//! This is the tiled N² test of the thesis (section 2.5.1): a workgroup loads a tile of AABBs, and every thread tests its own
//! mover against the tile. Two different objects may meet if their AABBs overlap (touching counts) and their groups (the low
//! 16 bits of the tags) are equal. A rod and a polygon make no entry. A rod and a box make `BOX_FEATURES` entries.
//!
//! The test is exact, because it only compares stored floats. So `fill_pairs` finds the same pairs.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::status::REBUILD_UNDER_WAY;
use crate::model::view::View;
use crate::model::world::World;
use crate::step::broad_phase::meet::for_each_pair;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_pairs",
    wgsl: Wgsl::File(part!("step/broad_phase/brute_force/count_pairs.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    moves: |_| Moves { aabbs: 1, counts: 1, ..NONE },
    cpu: count_pairs,
};

fn count_pairs(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let World { step, aabbs, topology, states, lists, .. } = world;
    let view = View::new(step, topology, &states[0]);
    let movers = step.layout.spheres + step.layout.rods;
    let (counts, padding) = lists[..step.layout.slices_at as usize].split_at_mut(movers as usize);
    counts.par_iter_mut().enumerate().with_min_len(GRAIN).for_each(|(mover, count)| {
        *count = 0;
        for_each_pair(&view, aabbs, mover as u32, |_| *count += 1);
    });
    padding.fill(0);
}
