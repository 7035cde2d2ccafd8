//! Collisions, where they are listed: every collision gets a record, which its entries on both sides name (docs/physics.md sections 3.5 to 3.7).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::stage::{Stage, part, read, write};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "list_collisions",
    parts: &[
        part!("model/step.wgsl"),
        part!("model/entries.wgsl"),
        part!("model/lists.wgsl"),
        part!("model/order.wgsl"),
        part!("model/one_state.wgsl"),
        part!("model/objects.wgsl"),
        part!("physics/geometry.wgsl"),
        part!("physics/contact.wgsl"),
        part!("step/collisions/has_changes.wgsl"),
        part!("step/collisions/rows.wgsl"),
        part!("physics/collision.wgsl"),
        part!("step/collisions/records.wgsl"),
        part!("step/collisions/tell_clusters.wgsl"),
        part!("step/collisions/list_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("slots", Buffer::Slots),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    cpu: list_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn list_collisions(_world: &mut World, _pass: u32) {}
