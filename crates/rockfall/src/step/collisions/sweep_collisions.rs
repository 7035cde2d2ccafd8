//! Makes one sweep over the impulses of collisions that share bodies (docs/physics section 3.7). Pass m
//! makes sweep m + 1 of [`SWEEPS`]. A record has room for two impulses: the pass reads the one after m sweeps and writes the
//! one after m + 1 sweeps.
//!
//! [`SWEEPS`]: crate::model::layout::SWEEPS

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
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
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: sweep_collisions,
};

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn sweep_collisions(_world: &mut World, _pass: u32) {}
