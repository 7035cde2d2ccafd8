//! Broad phase sort-and-skip, 1 of 4: sorts objects roughly by their least x (proposed in thesis section 2.5.1).
//!
//! Each pass sorts every block of 128 objects. In pass 1 the blocks begin half a block later. So an object moves by at most
//! one or two blocks each time lists are rebuilt, and the order improves gradually. The order only decides which blocks can
//! be skipped. Objects with the same least x are sorted by id. If `cells[2]` does not hold the number of objects, the order
//! of ids is the initial order.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::WORKGROUP;
use crate::model::part::part;
use crate::model::status::REBUILD_UNDER_WAY;
use crate::model::world::World;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sort_axis",
    wgsl: Wgsl::File(part!("step/broad_phase/sort_and_skip/sort_axis.wgsl")),
    bindings: &[read("aabbs", Buffer::Aabbs), write("cells", Buffer::Cells), read("status", Buffer::Status)],
    threads: Threads::Objects,
    moves: |_| Moves { aabbs: 1, keys: 2, ..NONE },
    cpu: sort_axis,
};

fn sort_axis(world: &mut World, pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let objects = world.objects();
    let is_ordered = world.cells[2] == objects;
    let order = &mut world.cells[world.step.layout.sorted_at as usize..][..objects as usize];
    if pass == 0 && !is_ordered {
        order.iter_mut().zip(0..).for_each(|(place, id)| *place = id);
    }
    let first = (pass * WORKGROUP).min(objects) as usize;
    for block in order[first..].chunks_mut(2 * WORKGROUP as usize) {
        block.sort_unstable_by(|a, b| {
            let least = |id: &u32| world.aabbs[*id as usize].min[0];
            least(a).total_cmp(&least(b)).then(a.cmp(b))
        });
    }
}
