//! Grid broad phase, 6 of 6: builds the list of every mover except the long ones, in ascending order of insertion index, then
//! feature.
//!
//! The condition for two objects to meet is that of `count_pairs`. If two rows of cells share places of the table, an object
//! may be found twice. Its entry is kept once.
//!
//! Slices get their rows in the order in which workgroups request them. The contents of a list do not depend on its place.
//! Long movers get as much room as `count_long` has counted. If the slices need more than `pair_rows` rows, the step is
//! rejected, and lists without room are empty.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::count_builds;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::layout::SLICE;
use crate::model::lists::{put_in_order, slices};
use crate::model::part::part;
use crate::model::status::{REBUILD_DONE, REJECTED_COUNT, REJECTED_PAIRS};
use crate::model::view::View;
use crate::model::world::World;
use crate::step::broad_phase::grid::cells::{Around, Grid};
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_neighbours",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/find_neighbours.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    moves: |_| Moves { aabbs: 1, cells: 1, keys: 1, extents: 1, counts: 1, entries: 1, ..NONE },
    cpu: find_neighbours,
};

/// Initial capacity for the entries of a slice. A larger slice has to reallocate, and threads that allocate wait for each
/// other.
const INITIAL_CAPACITY: usize = 20 * SLICE as usize;

fn find_neighbours(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let grid = Grid::new(view, &world.aabbs, &world.cells, &world.extents);
    let is_long = |mover: u32| grid.is_long(&world.aabbs[mover as usize]);
    let movers = world.step.layout.spheres + world.step.layout.rods;
    let found: Vec<Found> = (0..movers.div_ceil(SLICE))
        .into_par_iter()
        .with_min_len(GRAIN / SLICE as usize)
        .map_init(Around::default, |around, slice| {
            let mut found = Found { entries: Vec::with_capacity(INITIAL_CAPACITY), ..Found::default() };
            let mut counts = found.counts.iter_mut().zip(slice * SLICE..);
            grid.for_each_list(slice * SLICE..movers.min((slice + 1) * SLICE), around, &mut |entries| {
                put_in_order(&view, entries);
                found.entries.extend_from_slice(entries);
                if let Some((count, mover)) = counts.next() {
                    *count = if is_long(mover) { world.lists[mover as usize] } else { entries.len() as u32 };
                }
            });
            found
        })
        .collect();

    let (step, status) = (&world.step, &mut world.status);
    // Exact lists may be rebuilt a second time in a step.
    count_builds(status);
    status.rebuild = REBUILD_DONE;
    let (counts, offsets) = world.lists.split_at_mut(step.layout.slices_at as usize);
    for ((found, counts), offset) in found.iter().zip(counts.chunks_mut(SLICE as usize)).zip(offsets) {
        counts.copy_from_slice(&found.counts);
        *offset = status.pair_rows_needed;
        let longest = found.counts.iter().max().copied().unwrap_or(0);
        let (needed, wrapped) = offset.overflowing_add(longest);
        status.pair_rows_needed = needed;
        if wrapped {
            status.rejected |= REJECTED_COUNT;
        }
        if needed > step.layout.pair_rows {
            status.rejected |= REJECTED_PAIRS;
        }
    }
    if status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) != 0 {
        counts.fill(0);
        return;
    }
    slices(step, &mut world.lists).into_par_iter().zip(found).with_min_len(GRAIN / SLICE as usize).for_each(
        |(slice, found)| {
            let mut entries = found.entries.into_iter();
            for (place, count) in slice.counts.iter().enumerate() {
                let count = if is_long(slice.first + place as u32) { 0 } else { *count };
                let words = slice.words.iter_mut().skip(place).step_by(SLICE as usize);
                words.zip(entries.by_ref().take(count as usize)).for_each(|(word, entry)| *word = entry);
            }
        },
    );
}

/// The lists of the movers of a slice.
#[derive(Default)]
struct Found {
    /// The number of entries of each mover.
    counts: [u32; SLICE as usize],
    /// The entries of all movers, list after list.
    entries: Vec<u32>,
}
