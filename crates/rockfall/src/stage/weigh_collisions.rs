//! Collisions, 2 of 4: the weight s_k of every colliding contact (physics.md section 3).
//!
//! The weight goes to the entry of both sides; it is negative where the overlap is to be removed too, that is where
//! the row sum over all overlapping contacts is 1 within 0.001.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("stage/weigh_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("weights", Buffer::Weights),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: weigh_collisions,
};

fn weigh_collisions(_world: &mut World, _pass: u32) {
    unimplemented!()
}
