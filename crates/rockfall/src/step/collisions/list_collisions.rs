//! Collisions, where they are listed: every collision gets a record, which its entries on both sides name (docs/physics.md sections 3.5 to 3.7).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "list_collisions",
    wgsl: Wgsl::File(part!("step/collisions/list_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    cpu: list_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn list_collisions(_world: &mut World, _pass: u32) {}
