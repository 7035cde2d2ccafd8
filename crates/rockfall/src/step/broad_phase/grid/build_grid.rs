//! Grid broad phase, 1 to 5 of 6 in one, for small scenes: what `clear_cells`, `count_cells`, `sum_blocks`, `place_cells` and
//! `sort_cells` do, by one workgroup. A dispatch takes longer than what a few thousand objects give it to do.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::broad_phase::grid::{clear_cells, count_cells, scan_cells, sort_cells};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

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
    cpu: build_grid,
};

fn build_grid(world: &mut World, _pass: u32) {
    for stage in [&clear_cells::STAGE, &count_cells::STAGE, &scan_cells::SUM, &scan_cells::PLACE, &sort_cells::STAGE] {
        (stage.cpu)(world, 0);
    }
}
