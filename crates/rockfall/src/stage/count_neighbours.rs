//! Grid broad phase, 7 of 9: how many entries the list of every mover may have, and room for them.
//!
//! May meet: as in `count_pairs`. An entry may be counted twice, `order_pairs` mends that. A slice gets its place in the
//! order in which workgroups come to it; what is in a list does not depend on where it stands. More than `pair_capacity`
//! voids the step.

use rayon::prelude::*;

use crate::cpu::grid::Grid;
use crate::layout::{SLICE, VOID_COUNT, VOID_PAIRS};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_neighbours",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/neighbours.wgsl"),
        part!("stage/count_neighbours.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        write("lists", Buffer::Lists),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: count_neighbours,
};

fn count_neighbours(world: &mut World, _pass: u32) {
    let grid = Grid::new(&world.step, &world.aabbs, &world.cells);
    let movers = world.step.spheres + world.step.rods;
    let (counts, offsets) = world.lists.split_at_mut(world.step.slices_at as usize);
    let (counted, padding) = counts.split_at_mut(movers as usize);
    counted.par_iter_mut().enumerate().for_each(|(mover, count)| {
        *count = 0;
        grid.for_each_pair(mover as u32, |_| *count += 1);
    });
    padding.fill(0);
    for (slice, offset) in counts.chunks(SLICE as usize).zip(offsets) {
        *offset = world.status.pairs_needed;
        let longest = slice.iter().max().copied().unwrap_or(0);
        let (needed, wrapped) = offset.overflowing_add(longest * SLICE);
        world.status.pairs_needed = needed;
        if wrapped {
            world.status.void |= VOID_COUNT;
        }
        if needed > world.step.pair_capacity {
            world.status.void |= VOID_PAIRS;
        }
    }
}
