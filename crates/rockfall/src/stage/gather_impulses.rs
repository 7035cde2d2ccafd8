//! How the velocities of large spheres change by the impulses on them, after as many sweeps as the pass says (docs/physics.md section 3.7).
//! A workgroup works on each: hundreds of collisions may share one.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "gather_impulses",
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
        part!("wgsl/ordered_sums.wgsl"),
        part!("stage/gather_impulses.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("slots", Buffer::Slots),
        read("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::LargeSpheres,
    cpu: gather_impulses,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn gather_impulses(_world: &mut World, _pass: u32) {}
