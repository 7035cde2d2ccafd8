//! Collisions, where they are listed: which are lone, how much every other one has to be held back, and which others share a body with it
//! (docs/physics.md section 3). One that shares none is solved here; the others are left to sweeps, and the step is void where there
//! are none (`VOID_COLLISIONS`).

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
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
        part!("wgsl/plain.wgsl"),
        part!("wgsl/attached.wgsl"),
        part!("wgsl/sine.wgsl"),
        part!("wgsl/signed_touch.wgsl"),
        part!("wgsl/time_of_contact.wgsl"),
        part!("wgsl/company.wgsl"),
        part!("wgsl/records.wgsl"),
        part!("wgsl/record_of.wgsl"),
        part!("wgsl/impulses.wgsl"),
        part!("wgsl/tell_clusters.wgsl"),
        part!("wgsl/teams.wgsl"),
        part!("wgsl/couplings.wgsl"),
        part!("stage/weigh_collisions.wgsl"),
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
