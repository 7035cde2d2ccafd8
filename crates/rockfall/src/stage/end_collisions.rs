//! Closes the collisions: sets `collided`, and `lengths_due` where there were any. A stage of its own, because the stages
//! before it still ask `collided`. Does nothing in a void step.

use crate::stage::{Buffer, Stage, Threads, part, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "end_collisions",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/end_collisions.wgsl")],
    bindings: &[write("status", Buffer::Status)],
    threads: Threads::One,
    cpu: end_collisions,
};

fn end_collisions(world: &mut World, _pass: u32) {
    let status = &mut world.status;
    if status.void != 0 || status.collided != 0 {
        return;
    }
    status.collided = 1;
    if status.collisions > 0 {
        status.lengths_due = 1;
    }
}
