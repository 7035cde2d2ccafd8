//! Broad phase sort-and-skip, 2 of 4: writes the interval in x of every block of 64 sorted objects to `extents`.

use glam::Vec4;

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
    name: "bound_blocks",
    wgsl: Wgsl::File(part!("step/broad_phase/sort_and_skip/bound_blocks.wgsl")),
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("cells", Buffer::Cells),
        write("extents", Buffer::Extents),
        read("status", Buffer::Status),
    ],
    threads: Threads::Objects,
    moves: |_| Moves { aabbs: 1, keys: 1, ..NONE },
    cpu: bound_blocks,
};

fn bound_blocks(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    world.cells[2] = world.objects();
    let order = &world.cells[world.step.layout.sorted_at as usize..][..world.aabbs.len()];
    for (block, interval) in order.chunks(WORKGROUP as usize).zip(&mut world.extents) {
        let aabbs = || block.iter().map(|id| &world.aabbs[*id as usize]);
        let least = aabbs().map(|aabb| aabb.min[0]).fold(f32::INFINITY, f32::min);
        let greatest = aabbs().map(|aabb| aabb.max[0]).fold(f32::NEG_INFINITY, f32::max);
        *interval = Vec4::new(least, greatest, 0.0, 0.0);
    }
}
