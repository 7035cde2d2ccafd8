//! Collisions, 1 of 4: which pairs overlap, and which of them collide (physics.md section 3).
//!
//! Sets `ENTRY_OVERLAPS` and `ENTRY_COLLIDES` in the entries of both sides, once, so that no later stage decides again;
//! counts every collision once (at the mover of lower id). Voids the step when a sphere is outside its AABB
//! (`VOID_ESCAPED`). Like the other three it does nothing when the step is void or its collisions are done.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("stage/find_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        write("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: find_collisions,
};

fn find_collisions(_world: &mut World, _pass: u32) {
    unimplemented!()
}
