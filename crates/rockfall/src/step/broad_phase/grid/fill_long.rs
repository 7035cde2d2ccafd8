//! Grid broad phase, after 6 of 6: builds the lists of long movers, with a workgroup for each.
//!
//! The threads share the rows of cells, and find entries in any order. The entries are then sorted by insertion index, then
//! feature, and duplicates are dropped.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::SLICE;
use crate::model::lists::{put_in_order, slot};
use crate::model::part::part;
use crate::model::status::{REJECTED_COUNT, REJECTED_PAIRS};
use crate::model::view::View;
use crate::model::world::World;
use crate::step::broad_phase::grid::cells::{Around, Grid};
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_long",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/fill_long.wgsl")),
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
    cpu: fill_long,
};

fn fill_long(world: &mut World, _pass: u32) {
    if world.cells[1] == 0 {
        return;
    }
    let step = &world.step;
    let view = View::new(step, &world.topology, &world.states[0]);
    let grid = Grid::new(view, &world.aabbs, &world.cells, &world.extents);
    let fits = world.status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) == 0;
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
        let first = step.layout.entries_at as usize + slot(step, &world.lists, *mover, 0);
        for (place, entry) in entries.into_iter().enumerate() {
            world.lists[first + place * SLICE as usize] = entry;
        }
    }
}
