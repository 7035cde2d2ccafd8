//! Orientations, and the spin of capsules (physics.md section 5, E18).
//!
//! A sphere turns by its mean spin (exponential map). The first end of a capsule does both ends: common roll about
//! the axis, both turn with the axis, and what is left of their angular momentum returns as momentum of the ends.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "turn",
    parts: &[part!("wgsl/step.wgsl"), part!("wgsl/objects.wgsl"), part!("stage/turn.wgsl")],
    bindings: &[
        write("state", Buffer::Start),
        read("y3", Buffer::Y3),
        write("orientations", Buffer::Orientations),
        read("words", Buffer::Words),
        read("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: turn,
};

fn turn(_world: &mut World, _pass: u32) {
    unimplemented!()
}
