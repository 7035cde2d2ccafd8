//! All sweeps over the impulses of collisions that share bodies, by one workgroup, where collisions are few (docs/physics.md section 3.7): a
//! dispatch a sweep would take longer.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_at_once",
    wgsl: Wgsl::File(part!("step/collisions/sweep_at_once.wgsl")),
    bindings: &[write("collisions", Buffer::Collisions), write("status", Buffer::Status)],
    threads: Threads::One,
    cpu: sweep_at_once,
};

/// Nothing: `apply_collisions` solves them all on the CPU.
fn sweep_at_once(_world: &mut World, _pass: u32) {}
