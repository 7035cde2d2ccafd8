//! Grid broad phase, 8 of 9: the entries, in any order. Does nothing in a void step.

use crate::cpu::grid::Grid;
use crate::cpu::lists::fill_slices;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_neighbours",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/neighbours.wgsl"),
        part!("stage/fill_neighbours.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        write("lists", Buffer::Lists),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: fill_neighbours,
};

fn fill_neighbours(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    let grid = Grid::new(&world.step, &world.aabbs, &world.cells);
    fill_slices(&world.step, &mut world.lists, |mover, take| grid.for_each_pair(mover, take));
}
