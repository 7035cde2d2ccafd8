//! Grid broad phase, 2 of 6: finds the cell of every object, and counts the objects in each cell.
//!
//! The stage also records which levels have objects, and for each level the largest edge and the greatest absolute coordinate
//! of a centre. In scenes that may have long movers it collects them, in any order.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::layout::{CELLS_AT, EDGES_AT, FARTHEST_AT, MASK_AT};
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::world::World;
use crate::step::broad_phase::grid::cells::{greatest_coordinate, is_long, is_tested_apart, key_of};
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_cells",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/count_cells.wgsl")),
    bindings: &[read("aabbs", Buffer::Aabbs), write("cells", Buffer::Cells), read("status", Buffer::Status)],
    threads: Threads::WideObjects,
    // Adds to its cell, which is read and written; writes the key.
    moves: |_| Moves { aabbs: 1, cells: 2, keys: 1, ..NONE },
    cpu: count_cells,
};

fn count_cells(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_REQUESTED) {
        return;
    }
    let step = &world.step;
    let objects = world.aabbs.par_iter().with_min_len(GRAIN);
    let keys: Vec<_> = objects.map(|aabb| key_of(step, aabb)).collect();
    for (object, (key, level, largest)) in keys.into_iter().enumerate() {
        if !is_tested_apart(step, object as u32) {
            world.cells[MASK_AT as usize] |= 1 << level;
            let edge = &mut world.cells[(EDGES_AT + level) as usize];
            // Floats that are not negative have the order of their bits.
            *edge = (*edge).max(largest.max(0.0).to_bits());
            let far = &mut world.cells[(FARTHEST_AT + level) as usize];
            *far = (*far).max(greatest_coordinate(&world.aabbs[object]).to_bits());
        }
        if (object as u32) < step.layout.spheres + step.layout.rods && is_long(step, &world.aabbs[object]) {
            let at = step.layout.long_at + world.cells[3];
            world.cells[at as usize] = object as u32;
            world.cells[3] += 1;
        }
        world.cells[(CELLS_AT + key) as usize] += 1;
        world.cells[step.layout.keys_at as usize + object] = key;
    }
}
