//! Grid broad phase, before the last: how long the lists of long movers may become, so that their slices get room.
//!
//! A long mover looks at hundreds of objects and more: a workgroup shares out the rows of cells. Entries count twice that rows which
//! share places of the table hold both.

use rayon::prelude::*;

use crate::cpu::grid::{Around, Grid};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_long",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/put_head.wgsl"),
        part!("wgsl/meet.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/neighbours.wgsl"),
        part!("wgsl/long.wgsl"),
        part!("stage/count_long.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("words", Buffer::Words),
    ],
    threads: Threads::LongMovers,
    cpu: count_long,
};

fn count_long(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let grid = Grid::new(&world.step, &world.aabbs, &world.cells, &world.extents);
    let count = |around: &mut Around, mover: &u32| (*mover, grid.count_long(*mover, around));
    let counts: Vec<(u32, u32)> = grid.long_movers().par_iter().map_init(Around::default, count).collect();
    for (mover, count) in counts {
        world.lists[mover as usize] = count;
    }
}
