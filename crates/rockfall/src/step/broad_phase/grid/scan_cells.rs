//! Grid broad phase, 3 and 4 of 6: where every cell begins, the exclusive sums of the counts. In two dispatches: the sum of
//! every block of cells; then every block adds up the sums before its own, and goes on from there.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{CELL_BLOCK, CELLS_AT, SUM_WORDS};
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

/// The sum of every block.
pub(crate) const SUM: Stage = Stage {
    name: "sum_blocks",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/scan_cells.wgsl")),
    bindings: &[write("cells", Buffer::Cells), read("status", Buffer::Status)],
    threads: Threads::Blocks,
    cpu: sum_blocks,
};

/// Where every cell begins.
pub(crate) const PLACE: Stage = Stage { name: "place_cells", cpu: place_cells, ..SUM };

/// The cells, block by block, and the sums of the blocks.
fn blocks(world: &mut World) -> impl Iterator<Item = (&mut [u32], &mut [u32])> {
    let (cells, sums) = world.cells.split_at_mut(world.step.sums_at as usize);
    cells[CELLS_AT as usize..].chunks_mut(CELL_BLOCK as usize).zip(sums.chunks_mut(SUM_WORDS as usize))
}

fn sum_blocks(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.rejected != 0 {
        return;
    }
    for (cells, sum) in blocks(world) {
        // When digits are sorted, what stands beyond their counts is of no meaning.
        sum.fill(0);
        sum[0] = cells.iter().fold(0, |sum, count| sum.wrapping_add(*count));
    }
}

fn place_cells(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.rejected != 0 {
        return;
    }
    let mut before = 0_u32;
    for (cells, sum) in blocks(world) {
        // Every count becomes the sum of those before it.
        cells.iter_mut().fold(before, |before, count| before.wrapping_add(std::mem::replace(count, before)));
        before = before.wrapping_add(sum[0]);
    }
}
