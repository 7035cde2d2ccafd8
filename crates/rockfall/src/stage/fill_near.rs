//! Broad phase sort-and-skip, 4 of 4: the entries, in ascending order of index (in order
//! of addition), then feature.

use crate::cpu::broad::for_each_near;
use crate::cpu::lists::{fill_slices, put_in_order};
use crate::cpu::view::View;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_near",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/meet.wgsl"),
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
        put_in_order(&view, &mut entries);
        entries.into_iter().for_each(take);
    });
}
