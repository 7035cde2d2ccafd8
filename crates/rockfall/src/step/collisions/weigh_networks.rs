//! How heavy a network of fixed-length rods is for each collision on it (docs/physics.md section 3.6): its inverse mass there, times the
//! number of collisions on the network. A workgroup works on each network, on one collision after the other.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_networks",
    wgsl: Wgsl::File(part!("step/collisions/weigh_networks.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Networks,
    cpu: weigh_networks,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn weigh_networks(_world: &mut World, _pass: u32) {}
