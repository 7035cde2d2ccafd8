//! Computes the changes of velocity of networks of fixed-length rods by the impulses on them (docs/physics section 3.4).
//! Pass m takes the impulses after m sweeps. There is one workgroup per network.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "project_networks",
    wgsl: Wgsl::File(part!("step/collisions/project_networks.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Networks,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: project_networks,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn project_networks(_world: &mut World, _pass: u32) {}
