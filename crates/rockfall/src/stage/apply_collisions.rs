//! Collisions, 3 of 4: every sphere gathers its shares of the weighted impulses and displacements (physics.md section 3).
//!
//! The new state goes to `Y2`, for the others still read the old one. A body that would stop being finite keeps its
//! position, loses velocity and spin, and is reported.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "apply_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("stage/apply_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("weights", Buffer::Weights),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: apply_collisions,
};

fn apply_collisions(_world: &mut World, _pass: u32) {
    unimplemented!()
}
