//! Collisions, where they are listed: which are lone, how much every other one has to be held back, and which others share a body with it
//! (docs/physics.md section 3). One that shares none is solved here; the others are left to sweeps, and the step is void where there
//! are none (`VOID_COLLISIONS`).

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::stage::{Stage, part, read, write};

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
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
        part!("physics/collision/plain.wgsl"),
        part!("physics/forces/attached.wgsl"),
        part!("physics/sine.wgsl"),
        part!("physics/signed_touch.wgsl"),
        part!("physics/collision/time_of_contact.wgsl"),
        part!("physics/collision/company.wgsl"),
        part!("step/collisions/records.wgsl"),
        part!("step/collisions/record_of.wgsl"),
        part!("physics/collision/impulses.wgsl"),
        part!("step/collisions/tell_clusters.wgsl"),
        part!("step/large_spheres/teams.wgsl"),
        part!("physics/collision/couplings.wgsl"),
        part!("step/collisions/weigh_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("slots", Buffer::Slots),
        write("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Collisions,
    cpu: weigh_collisions,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn weigh_collisions(_world: &mut World, _pass: u32) {}
