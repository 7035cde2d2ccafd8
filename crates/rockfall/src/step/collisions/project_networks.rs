//! How the velocities of networks of fixed-length rods change by the impulses on them, after as many sweeps as the pass says
//! (docs/physics.md section 3.6). A workgroup works on each network.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
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
    cpu: project_networks,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn project_networks(_world: &mut World, _pass: u32) {}
