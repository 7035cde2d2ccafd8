//! Grid broad phase, 3 to 5 of 7: where every cell begins, the exclusive sums of the counts. In three dispatches: the sum
//! of every block of cells, the sums of those, and the cells of every block from there.

use crate::layout::{CELL_BLOCK, CELLS_AT};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The sum of every block.
pub(crate) const SUM: Stage = Stage {
    name: "sum_blocks",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/scan_cells.wgsl")],
    bindings: &[write("cells", Buffer::Cells), read("status", Buffer::Status)],
    threads: Threads::Blocks,
    cpu: sum_blocks,
};

/// Where every block begins.
pub(crate) const SCAN: Stage = Stage { name: "scan_blocks", threads: Threads::One, cpu: scan_blocks, ..SUM };

/// Where every cell begins.
pub(crate) const PLACE: Stage = Stage { name: "place_cells", cpu: place_cells, ..SUM };

/// The cells, block by block, and the sums of the blocks.
fn blocks(world: &mut World) -> impl Iterator<Item = (&mut [u32], &mut u32)> {
    let (cells, sums) = world.cells.split_at_mut(world.step.sums_at as usize);
    cells[CELLS_AT as usize..].chunks_mut(CELL_BLOCK as usize).zip(sums)
}

/// Makes every number the sum of those before it.
fn scan<'a>(numbers: impl Iterator<Item = &'a mut u32>, first: u32) {
    numbers.fold(first, |before, number| before + std::mem::replace(number, before));
}

fn sum_blocks(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.void != 0 {
        return;
    }
    for (cells, sum) in blocks(world) {
        *sum = cells.iter().sum();
    }
}

fn scan_blocks(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.void != 0 {
        return;
    }
    scan(blocks(world).map(|(_, sum)| sum), 0);
}

fn place_cells(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.void != 0 {
        return;
    }
    for (cells, sum) in blocks(world) {
        scan(cells.iter_mut(), *sum);
    }
}
