//! After symplectic Euler: `Y2` becomes the state. Does nothing in a void step.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_leap",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/commit_leap.wgsl")],
    bindings: &[write("state", Buffer::Start), read("next", Buffer::Y2), read("status", Buffer::Status)],
    threads: Threads::Spheres,
    cpu: commit_leap,
};

fn commit_leap(world: &mut World, _pass: u32) {
    if world.status.void == 0 {
        let [start, y2, ..] = &mut world.states;
        start.copy_from_slice(y2);
    }
}
