//! Collisions, where they are listed: every collision gets a record, which its entries on both sides name (docs/physics.md sections 3.5 to 3.7).

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "list_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/has_changes.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/records.wgsl"),
        part!("wgsl/tell_clusters.wgsl"),
        part!("stage/list_collisions.wgsl"),
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
