//! AABBs of all objects, static ones too, grown by the motion of the step.
//!
//! A sphere moves by at most its margin `margin_scale (|v| dt + 0.02 r)` before its list is made again; where it moves
//! further, `find_collisions`, `advance` or `leap` void the step, the host raises `margin_scale`, and the step is run again.
//! A rod takes the hull of its ends, each with its own margin and the radius of the rod.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "update_aabbs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("stage/update_aabbs.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        write("aabbs", Buffer::Aabbs),
    ],
    threads: Threads::Objects,
    cpu: update_aabbs,
};

fn update_aabbs(_world: &mut World, _pass: u32) {
    unimplemented!()
}
