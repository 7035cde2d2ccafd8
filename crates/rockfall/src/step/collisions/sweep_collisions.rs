//! A sweep over the impulses of collisions that share bodies (docs/physics.md section 3.7). Pass m makes sweep m + 1 of [`SWEEPS`]: it
//! reads the impulses after m sweeps and writes those after one more beside them.
//!
//! [`SWEEPS`]: crate::model::layout::SWEEPS

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_collisions",
    wgsl: Wgsl::File(part!("step/collisions/sweep_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Collisions,
    cpu: sweep_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn sweep_collisions(_world: &mut World, _pass: u32) {}
