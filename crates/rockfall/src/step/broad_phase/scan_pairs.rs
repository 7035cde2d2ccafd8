//! Broad phase, 2 of 3: computes where the slices begin, and whether the entries fit.
//!
//! A slice is as wide as its longest list. So the slice offsets are the exclusive prefix sums of `max(counts of the slice)`.
//! The offset after the last slice is the total. If the total exceeds `pair_rows`, the step is rejected with
//! `REJECTED_PAIRS`. The total is written to `pair_rows_needed`.

use crate::model::buffer::Buffer;
use crate::model::counters::count_builds;
use crate::model::dispatch::Threads;
use crate::model::layout::SLICE;
use crate::model::part::part;
use crate::model::status::{REBUILD_DONE, REBUILD_UNDER_WAY, REJECTED_PAIRS};
use crate::model::world::World;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "scan_pairs",
    wgsl: Wgsl::File(part!("step/broad_phase/scan_pairs.wgsl")),
    bindings: &[write("lists", Buffer::Lists), write("status", Buffer::Status)],
    threads: Threads::One,
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: scan_pairs,
};

fn scan_pairs(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let (counts, offsets) = world.lists.split_at_mut(world.step.layout.slices_at as usize);
    let mut total = 0u32;
    for (slice, offset) in counts.chunks(SLICE as usize).zip(&mut *offsets) {
        *offset = total;
        total = total.saturating_add(slice.iter().max().copied().unwrap_or(0));
    }
    offsets[counts.len() / SLICE as usize] = total;
    world.status.pair_rows_needed = total;
    count_builds(&mut world.status);
    world.status.rebuild = REBUILD_DONE;
    if total > world.step.layout.pair_rows {
        world.status.rejected |= REJECTED_PAIRS;
    }
}
