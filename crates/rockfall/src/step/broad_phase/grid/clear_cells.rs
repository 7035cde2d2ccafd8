//! Grid broad phase, 1 of 6: clears the table of cells.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{CELLS_AT, MASK_AT};
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::world::World;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "clear_cells",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/clear_cells.wgsl")),
    bindings: &[write("cells", Buffer::Cells), write("status", Buffer::Status)],
    threads: Threads::Blocks,
    moves: |_| Moves { cells: 1, ..NONE },
    cpu: clear_cells,
};

fn clear_cells(world: &mut World, _pass: u32) {
    world.cells[1] = u32::from(world.status.builds_lists(REBUILD_REQUESTED));
    if world.cells[1] == 0 {
        return;
    }
    world.cells[3] = 0;
    world.cells[MASK_AT as usize..(CELLS_AT + world.step.layout.cells) as usize].fill(0);
    world.status.pair_rows_needed = 0;
}
