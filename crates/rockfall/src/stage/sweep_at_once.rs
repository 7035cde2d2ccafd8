//! All sweeps over the impulses of collisions that share bodies, by one workgroup, where collisions are few (docs/physics.md section 3.7): a
//! dispatch a sweep would take longer.

use crate::stage::{Buffer, Stage, Threads, part, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_at_once",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/entries.wgsl"),
        part!("wgsl/records.wgsl"),
        part!("wgsl/has_changes.wgsl"),
        part!("wgsl/sweep.wgsl"),
        part!("stage/sweep_at_once.wgsl"),
    ],
    bindings: &[write("collisions", Buffer::Collisions), write("status", Buffer::Status)],
    threads: Threads::One,
    cpu: sweep_at_once,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn sweep_at_once(_world: &mut World, _pass: u32) {}
