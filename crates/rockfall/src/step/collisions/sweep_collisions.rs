//! A sweep over the impulses of collisions that share bodies (docs/physics.md section 3.7). Pass m makes sweep m + 1 of [`SWEEPS`]: it
//! reads the impulses after m sweeps and writes those after one more beside them.
//!
//! [`SWEEPS`]: crate::model::layout::SWEEPS

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::stage::{Stage, part, read, write};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_collisions",
    parts: &[
        part!("model/step.wgsl"),
        part!("model/entries.wgsl"),
        part!("model/lists.wgsl"),
        part!("model/order.wgsl"),
        part!("model/one_state.wgsl"),
        part!("model/objects.wgsl"),
        part!("physics/geometry.wgsl"),
        part!("physics/contact.wgsl"),
        part!("step/collisions/has_changes.wgsl"),
        part!("step/collisions/rows.wgsl"),
        part!("physics/collision.wgsl"),
        part!("step/collisions/records.wgsl"),
        part!("step/collisions/record_of.wgsl"),
        part!("physics/collision/impulses.wgsl"),
        part!("step/large_spheres/teams.wgsl"),
        part!("physics/collision/sweep.wgsl"),
        part!("step/collisions/sweep_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("slots", Buffer::Slots),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Collisions,
    cpu: sweep_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn sweep_collisions(_world: &mut World, _pass: u32) {}
