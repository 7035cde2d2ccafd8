//! Grid broad phase, 1 to 5 of 6 in one, for small scenes: what `clear_cells`, `count_cells`, `sum_blocks`, `place_cells` and
//! `sort_cells` do, by one workgroup. A dispatch takes longer than what a few thousand objects give it to do.

use crate::stage::{Buffer, Stage, Threads, clear_cells, count_cells, part, read, scan_cells, sort_cells, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "build_grid",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/count_object.wgsl"),
        part!("wgsl/place_object.wgsl"),
        part!("wgsl/scan.wgsl"),
        part!("stage/build_grid.wgsl"),
    ],
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
