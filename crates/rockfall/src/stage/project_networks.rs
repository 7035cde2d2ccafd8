//! How the velocities of networks of fixed-length rods change by the impulses on them, after as many sweeps as the pass says
//! (docs/physics.md section 3.6). A workgroup works on each network.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "project_networks",
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
        part!("wgsl/impulses.wgsl"),
        part!("wgsl/networks.wgsl"),
        part!("stage/project_networks.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("slots", Buffer::Slots),
        read("collisions", Buffer::Collisions),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Networks,
    cpu: project_networks,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn project_networks(_world: &mut World, _pass: u32) {}
