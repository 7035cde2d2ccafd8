//! Broad phase sort-and-skip, 4 of 4: writes the entries, in ascending order of insertion index, then feature.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::lists::{fill_slices, put_in_order};
use crate::model::part::part;
use crate::model::status::REBUILD_UNDER_WAY;
use crate::model::view::View;
use crate::model::world::World;
use crate::step::broad_phase::meet::for_each_near;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_near",
    wgsl: Wgsl::File(part!("step/broad_phase/sort_and_skip/fill_near.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Objects,
    moves: |_| Moves { aabbs: 1, keys: 1, counts: 1, entries: 1, ..NONE },
    cpu: fill_near,
};

fn fill_near(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let World { step, cells, extents, aabbs, lists, topology, states, .. } = world;
    let view = View::new(step, topology, &states[0]);
    fill_slices(step, lists, |mover, take| {
        let mut entries = Vec::new();
        for_each_near(&view, aabbs, cells, extents, mover, |entry| entries.push(entry));
        put_in_order(&view, &mut entries);
        entries.into_iter().for_each(take);
    });
}
