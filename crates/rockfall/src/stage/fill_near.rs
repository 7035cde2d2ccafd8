//! Broad phase sort-and-skip, 4 of 4: the entries, in ascending order of index (in order
//! of addition), then feature.

use crate::cpu::broad::for_each_near;
use crate::cpu::lists::fill_slices;
use crate::cpu::view::View;
use crate::layout::{ENTRY_FEATURE_MASK, ENTRY_ID_BITS, ENTRY_ID_MASK};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_near",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/heap.wgsl"),
        part!("wgsl/axis.wgsl"),
        part!("wgsl/near_tiles.wgsl"),
        part!("stage/fill_near.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("extents", Buffer::Extents),
        write("lists", Buffer::Lists),
        read("words", Buffer::Words),
        read("status", Buffer::Status),
    ],
    threads: Threads::Objects,
    cpu: fill_near,
};

fn fill_near(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 || world.status.void != 0 {
        return;
    }
    let World { step, cells, extents, aabbs, lists, words, states, .. } = world;
    let view = View::new(step, words, &states[0]);
    fill_slices(step, lists, |mover, take| {
        let mut entries = Vec::new();
        for_each_near(step, aabbs, cells, extents, mover, |entry| entries.push(entry));
        entries.sort_unstable_by_key(|entry| (view.user(entry & ENTRY_ID_MASK), entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK));
        entries.into_iter().for_each(take);
    });
}
