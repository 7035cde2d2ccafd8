//! Broad phase sort-and-skip, 3 of 4: counts the entries of every mover. Blocks whose interval does not meet that of the
//! mover's block are skipped. `scan_pairs` runs between this stage and `fill_near`.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
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
    name: "count_near",
    wgsl: Wgsl::File(part!("step/broad_phase/sort_and_skip/count_near.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Objects,
    moves: |_| Moves { aabbs: 1, keys: 1, counts: 1, ..NONE },
    cpu: count_near,
};

fn count_near(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let World { step, cells, extents, aabbs, lists, topology, states, .. } = world;
    let view = View::new(step, topology, &states[0]);
    let (counts, padding) =
        lists[..step.layout.slices_at as usize].split_at_mut((step.layout.spheres + step.layout.rods) as usize);
    counts.par_iter_mut().zip(0..step.layout.spheres + step.layout.rods).with_min_len(GRAIN).for_each(|(count, mover)| {
        *count = 0;
        for_each_near(&view, aabbs, cells, extents, mover, |_| *count += 1);
    });
    padding.fill(0);
}
