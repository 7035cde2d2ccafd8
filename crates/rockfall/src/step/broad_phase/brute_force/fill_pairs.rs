//! Broad phase, 3 of 3: writes the entries, in ascending order of id, then feature. Does nothing in a step that the host repeats.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::lists::fill_slices;
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
    name: "fill_pairs",
    wgsl: Wgsl::File(part!("step/broad_phase/brute_force/fill_pairs.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    moves: |_| Moves { aabbs: 1, counts: 1, entries: 1, ..NONE },
    cpu: fill_pairs,
};

fn fill_pairs(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let World { step, aabbs, topology, states, lists, .. } = world;
    let view = View::new(step, topology, &states[0]);
    fill_slices(step, lists, |mover, take| for_each_pair(&view, aabbs, mover, take));
}
