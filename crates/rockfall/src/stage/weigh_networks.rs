//! How heavy a network of fixed-length rods is for each collision on it (docs/physics.md section 3.6): its inverse mass there, times the
//! number of collisions on the network. A workgroup works on each network, on one collision after the other.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_networks",
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
        part!("wgsl/record_of.wgsl"),
        part!("wgsl/networks.wgsl"),
        part!("stage/weigh_networks.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("slots", Buffer::Slots),
        write("collisions", Buffer::Collisions),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Networks,
    cpu: weigh_networks,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn weigh_networks(_world: &mut World, _pass: u32) {}
