//! How the velocities of large spheres change by the impulses on them, after as many sweeps as the pass says (docs/physics.md section 3.7).
//! A workgroup works on each: hundreds of collisions may share one.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::stage::{Stage, part, read, write};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "gather_impulses",
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
        part!("step/large_spheres/ordered_sums.wgsl"),
        part!("step/collisions/gather_impulses.wgsl"),
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
