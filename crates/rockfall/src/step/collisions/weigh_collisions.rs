//! Prepares the listed collisions for the sweeps (docs/physics sections 3.5 to 3.7).
//!
//! The stage finds out which collisions are lone. For every other collision it computes the weight, which is the scale of its
//! impulse in the sweeps, and finds the collisions that share a body with it. A collision that shares no body with another one
//! is solved here, unless one of its bodies is a network. The others are left to the sweeps. If the step was begun without
//! sweeps, it is rejected (`REJECTED_COLLISIONS`).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
    wgsl: Wgsl::File(part!("step/collisions/weigh_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Collisions,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: weigh_collisions,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn weigh_collisions(_world: &mut World, _pass: u32) {}
