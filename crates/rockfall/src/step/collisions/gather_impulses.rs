//! Sums the impulses on bodies that many collisions share (docs/physics section 3.7): computes the changes of velocity of large
//! spheres. Pass m takes the impulses after m sweeps. There is one workgroup per large sphere, because hundreds of collisions
//! may share one.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "gather_impulses",
    wgsl: Wgsl::File(part!("step/collisions/gather_impulses.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Gathered,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: gather_impulses,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn gather_impulses(_world: &mut World, _pass: u32) {}
