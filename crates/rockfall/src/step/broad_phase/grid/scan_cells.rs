//! Grid broad phase, 3 and 4 of 6: computes where every cell begins, as exclusive prefix sums of the counts.
//!
//! This takes two dispatches. The first computes the sum of every block of cells. In the second every block adds up the sums
//! of the blocks before it, and continues from there with its own cells.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{CELL_BLOCK, CELLS_AT, SUM_WORDS};
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::world::World;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage that computes the sum of every block.
pub(crate) const SUM: Stage = Stage {
    name: "sum_blocks",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/scan_cells.wgsl")),
    bindings: &[write("cells", Buffer::Cells), read("status", Buffer::Status)],
    threads: Threads::Blocks,
    moves: |_| Moves { cells: 1, ..NONE },
    cpu: sum_blocks,
};

/// The stage that computes where every cell begins.
pub(crate) const PLACE: Stage = Stage { name: "place_cells", moves: |_| Moves { cells: 2, ..NONE }, cpu: place_cells, ..SUM };

/// Returns the cells of each block together with the words of its sum.
fn blocks(world: &mut World) -> impl Iterator<Item = (&mut [u32], &mut [u32])> {
    let (cells, sums) = world.cells.split_at_mut(world.step.layout.sums_at as usize);
    cells[CELLS_AT as usize..].chunks_mut(CELL_BLOCK as usize).zip(sums.chunks_mut(SUM_WORDS as usize))
}

fn sum_blocks(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_REQUESTED) {
        return;
    }
    for (cells, sum) in blocks(world) {
        // The sum may wrap: when digits are sorted, the words after their counts hold leftovers.
        sum.fill(0);
        sum[0] = cells.iter().fold(0, |sum, count| sum.wrapping_add(*count));
    }
}

fn place_cells(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_REQUESTED) {
        return;
    }
    let mut before = 0_u32;
    for (cells, sum) in blocks(world) {
        // Replaces every count by the sum of the counts before it.
        cells.iter_mut().fold(before, |before, count| before.wrapping_add(std::mem::replace(count, before)));
        before = before.wrapping_add(sum[0]);
    }
}
