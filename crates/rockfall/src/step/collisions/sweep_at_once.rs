//! Makes all sweeps over the impulses of collisions that share bodies, in one workgroup (docs/physics section 3.7). It
//! is used where collisions are few: one dispatch per sweep would take longer.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::traits::Traits;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "sweep_at_once",
    wgsl: Wgsl::File(part!("step/collisions/sweep_at_once.wgsl")),
    bindings: &[write("collisions", Buffer::Collisions), write("status", Buffer::Status)],
    threads: Threads::One,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: sweep_at_once,
};

/// Whether one workgroup may do all sweeps when there are few collisions.
pub(crate) fn fits(traits: &Traits) -> bool {
    !(traits.networks || traits.large)
}

/// Does nothing: on the CPU, `apply_collisions` solves all collisions.
fn sweep_at_once(_world: &mut World, _pass: u32) {}
