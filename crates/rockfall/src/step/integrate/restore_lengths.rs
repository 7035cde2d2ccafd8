//! Removes errors of rod lengths from the scene or from an edit, in positions only (docs/physics.md section 5.4).
//!
//! Runs when `lengths_due` is set. The first pass of `loads` clears it, so the correction is not made again when the
//! step is repeated.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, along_axis};
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "restore_lengths",
    wgsl: Wgsl::File(part!("step/integrate/restore_lengths.wgsl")),
    bindings: &[write("state", Buffer::Start), read("topology", Buffer::Topology), read("status", Buffer::Status)],
    threads: Threads::Batches,
    moves: |_| NONE,
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
