//! Grid broad phase, 5 of 6: sorts the objects by their keys. Objects of the same cell come in any order.
//!
//! Each object that is placed in a cell advances the stored start of the cell. After all objects are placed, the stored number is
//! the end of the cell, which is also where the next cell begins.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::CELLS_AT;
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::world::World;
use crate::step::broad_phase::grid::cells::sorted_extent;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sort_cells",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/sort_cells.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("cells", Buffer::Cells),
        write("extents", Buffer::Extents),
        read("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    // Reads the key, writes the id and the extent.
    moves: |_| Moves { aabbs: 1, cells: 2, keys: 2, extents: 1, ..NONE },
    cpu: sort_cells,
};

fn sort_cells(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_REQUESTED) {
        return;
    }
    let step = &world.step;
    for object in 0..world.aabbs.len() {
        let key = world.cells[step.layout.keys_at as usize + object];
        let cell = (CELLS_AT + key) as usize;
        let place = world.cells[cell];
        world.cells[cell] += 1;
        world.cells[(step.layout.sorted_at + place) as usize] = object as u32;
        world.extents[place as usize] = sorted_extent(step, object as u32, &world.aabbs[object]);
    }
}
