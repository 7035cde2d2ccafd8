//! Grid broad phase, between 5 and 6 of 6: counts the entries of long movers, so that their slices get enough room.
//!
//! A long mover has to test hundreds of objects or more, so the threads of a workgroup share its rows of cells. The count is
//! an upper bound: if two rows share places of the table, entries found in both rows count twice.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::step::broad_phase::grid::cells::{Around, Grid};
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_long",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/count_long.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::LongMovers,
    // Few movers are long.
    moves: |_| NONE,
    cpu: count_long,
};

fn count_long(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let grid = Grid::new(view, &world.aabbs, &world.cells, &world.extents);
    let count = |around: &mut Around, mover: &u32| (*mover, grid.count_long(*mover, around));
    let counts: Vec<(u32, u32)> = grid.long_movers().par_iter().map_init(Around::default, count).collect();
    for (mover, count) in counts {
        world.lists[mover as usize] = count;
    }
}
