//! A sweep over the impulses of collisions that share bodies (docs/physics.md section 3.7). Pass m makes sweep m + 1 of [`SWEEPS`]: it
//! reads the impulses after m sweeps and writes those after one more beside them.
//!
//! [`SWEEPS`]: crate::layout::SWEEPS

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/has_changes.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/records.wgsl"),
        part!("wgsl/record_of.wgsl"),
        part!("wgsl/impulses.wgsl"),
        part!("wgsl/teams.wgsl"),
        part!("wgsl/sweep.wgsl"),
        part!("stage/sweep_collisions.wgsl"),
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
