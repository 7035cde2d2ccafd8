//! Broad phase, 3 of 3: the entries, in ascending order of id, then feature. Does nothing in a void step.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "fill_pairs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/pair_tiles.wgsl"),
        part!("stage/fill_pairs.wgsl"),
    ],
    bindings: &[
        read("aabbs", Buffer::Aabbs),
        write("lists", Buffer::Lists),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: fill_pairs,
};

fn fill_pairs(_world: &mut World, _pass: u32) {
    unimplemented!()
}
