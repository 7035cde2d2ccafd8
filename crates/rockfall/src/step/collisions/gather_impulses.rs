//! How the velocities of large spheres change by the impulses on them, after as many sweeps as the pass says (docs/physics.md section 3.7).
//! A workgroup works on each: hundreds of collisions may share one.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
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
    threads: Threads::LargeSpheres,
    cpu: gather_impulses,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn gather_impulses(_world: &mut World, _pass: u32) {}
