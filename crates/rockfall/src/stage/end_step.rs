//! Closes the step: counters move to `last_*` and the totals, `collided` is cleared, and a body that stopped being finite
//! voids the steps after this one unless `FLAG_CONTINUE` is set. Does nothing in a void step.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "end_step",
    parts: &[part!("wgsl/step.wgsl"), part!("stage/end_step.wgsl")],
    bindings: &[write("status", Buffer::Status)],
    threads: Threads::One,
    cpu: end_step,
};

fn end_step(_world: &mut World, _pass: u32) {
    unimplemented!()
}
