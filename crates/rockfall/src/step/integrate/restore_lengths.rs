//! Removes the errors of rod lengths that were there before the integration, in positions only (docs/physics.md section 5.4).
//!
//! Runs where `lengths_due` is set; the first pass of `rod_forces` clears it, so that a step that is run again does not
//! repeat it.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, along_axis};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "restore_lengths",
    wgsl: Wgsl::File(part!("step/integrate/restore_lengths.wgsl")),
    bindings: &[write("state", Buffer::Start), read("topology", Buffer::Topology), read("status", Buffer::Status)],
    threads: Threads::Batches,
    cpu: restore_lengths,
};

fn restore_lengths(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.lengths_due == 0 {
        return;
    }
    let World { step, topology, states, .. } = world;
    for batch in 0..step.batches {
        Batch::new(step, topology, batch).sweep(step, &mut states[0], |ends, _| along_axis(ends));
    }
}
