//! Collisions, where they are listed: which are lone, how much every other one has to be held back, and which others share a body with it
//! (docs/physics.md section 3). One that shares none is solved here; the others are left to sweeps, and the step is void where there
//! are none (`REJECTED_COLLISIONS`).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
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
    cpu: weigh_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn weigh_collisions(_world: &mut World, _pass: u32) {}
