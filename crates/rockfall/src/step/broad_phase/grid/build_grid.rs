//! Grid broad phase, 1 to 5 of 6, for small scenes: one workgroup does the work of `clear_cells`, `count_cells`, `sum_blocks`,
//! `place_cells` and `sort_cells`. With a few thousand objects, launching a dispatch takes longer than its work.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::broad_phase::grid::{clear_cells, count_cells, scan_cells, sort_cells};
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "build_grid",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/build_grid.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("cells", Buffer::Cells),
        write("extents", Buffer::Extents),
        write("status", Buffer::Status),
    ],
    threads: Threads::One,
    // The sum of the following five stages before `find_neighbours`.
    moves: |_| Moves { aabbs: 2, cells: 6, keys: 3, extents: 1, ..NONE },
    cpu: build_grid,
};

fn build_grid(world: &mut World, _pass: u32) {
    for stage in [&clear_cells::STAGE, &count_cells::STAGE, &scan_cells::SUM, &scan_cells::PLACE, &sort_cells::STAGE] {
        (stage.cpu)(world, 0);
    }
}
