//! Grid broad phase, 6 of 6: the list of every mover, in ascending order of index (in order of addition), then feature.
//!
//! May meet: as in `count_pairs`. Where two rows of cells share places of the table an object is met twice; its entry is
//! kept once. A slice gets its place in the order in which workgroups come to it; what is in a list does not depend on
//! where it stands. More than `pair_capacity` voids the step, and its lists are empty.

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::grid::Grid;
use crate::cpu::lists::put_in_order;
use crate::cpu::view::View;
use crate::layout::{SLICE, VOID_COUNT, VOID_PAIRS};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_neighbours",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/meet.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/heap.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/neighbours.wgsl"),
        part!("stage/find_neighbours.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("words", Buffer::Words),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: find_neighbours,
};

fn find_neighbours(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let movers = world.step.spheres + world.step.rods;
    let view = View::new(&world.step, &world.words, &world.states[0]);
    let grid = Grid::new(&world.step, &world.aabbs, &world.cells);
    let found: Vec<Vec<u32>> =
        (0..movers).into_par_iter().with_min_len(GRAIN).map(|mover| neighbours(&grid, &view, mover)).collect();

    let (step, status) = (&world.step, &mut world.status);
    for (slice, lists) in found.chunks(SLICE as usize).enumerate() {
        let longest = lists.iter().map(Vec::len).max().unwrap_or(0) as u32;
        let offset = status.pairs_needed;
        world.lists[step.slices_at as usize + slice] = offset;
        let (needed, wrapped) = offset.overflowing_add(longest * SLICE);
        status.pairs_needed = needed;
        if wrapped {
            status.void |= VOID_COUNT;
        }
        if needed > step.pair_capacity {
            status.void |= VOID_PAIRS;
        }
    }
    if status.void & (VOID_PAIRS | VOID_COUNT) != 0 {
        world.lists[..step.slices_at as usize].fill(0);
        return;
    }
    for (mover, entries) in found.into_iter().enumerate() {
        let slice = mover / SLICE as usize;
        let first = step.entries_at + world.lists[step.slices_at as usize + slice] + mover as u32 % SLICE;
        world.lists[mover] = entries.len() as u32;
        for (place, entry) in entries.into_iter().enumerate() {
            world.lists[first as usize + place * SLICE as usize] = entry;
        }
    }
    world.lists[movers as usize..step.slices_at as usize].fill(0);
}

/// The entries of a mover, each once, in ascending order.
fn neighbours(grid: &Grid, view: &View, mover: u32) -> Vec<u32> {
    let mut entries = Vec::new();
    grid.for_each_pair(mover, |entry| entries.push(entry));
    put_in_order(view, &mut entries);
    entries.dedup();
    entries
}
