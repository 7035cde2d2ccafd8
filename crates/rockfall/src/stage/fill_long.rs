//! Grid broad phase, after the last: the lists of long movers, each found and put in order by a workgroup.
//!
//! The threads share out the rows of cells; what they find comes in any order, is ordered by index (in order of addition), then
//! feature, and kept once.

use rayon::prelude::*;

use crate::cpu::grid::{Around, Grid};
use crate::cpu::lists::{put_in_order, slot};
use crate::cpu::view::View;
use crate::layout::{SLICE, VOID_COUNT, VOID_PAIRS};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_long",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/put_head.wgsl"),
        part!("wgsl/meet.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/grid.wgsl"),
        part!("wgsl/neighbours.wgsl"),
        part!("wgsl/long.wgsl"),
        part!("wgsl/scan.wgsl"),
        part!("wgsl/bitonic.wgsl"),
        part!("stage/fill_long.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("words", Buffer::Words),
        read("status", Buffer::Status),
    ],
    threads: Threads::LongMovers,
    cpu: fill_long,
};

fn fill_long(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let step = &world.step;
    let view = View::new(step, &world.words, &world.states[0]);
    let grid = Grid::new(step, &world.aabbs, &world.cells, &world.extents);
    let fits = world.status.void & (VOID_PAIRS | VOID_COUNT) == 0;
    let found: Vec<Vec<u32>> = grid
        .long_movers()
        .par_iter()
        .map_init(Around::default, |around, mover| {
            if !fits {
                return Vec::new();
            }
            let entries = grid.long_list(*mover, around);
            put_in_order(&view, entries);
            entries.to_vec()
        })
        .collect();
    for (mover, entries) in grid.long_movers().iter().zip(found) {
        world.lists[*mover as usize] = entries.len() as u32;
        let first = step.entries_at as usize + slot(step, &world.lists, *mover, 0);
        for (place, entry) in entries.into_iter().enumerate() {
            world.lists[first + place * SLICE as usize] = entry;
        }
    }
}
