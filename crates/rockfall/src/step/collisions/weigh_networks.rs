//! Computes what a network of fixed-length rods adds to the weight of each collision on it: the sum of its absolute couplings
//! with all collisions on the network (docs/physics sections 3.4 and 3.7), and the projected inverse mass. There is one
//! workgroup per network. It handles one collision after the other.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
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
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: weigh_networks,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn weigh_networks(_world: &mut World, _pass: u32) {}
