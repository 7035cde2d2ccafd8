//! Corrects the lengths of fixed-length rods (docs/physics section 5.4). After the integration: SHAKE along the old directions, then
//! RATTLE. Pass 0 corrects the state. Velocity Verlet also corrects `Y4`, the state after the drift, in pass 3.
//!
//! Pass [`RESTORING`] removes errors of lengths from the scene or from an edit, before the integration and in positions only. It
//! does so when `lengths_due` is set. The first pass of `loads` clears that, so the correction is not made again when the step is
//! repeated.
//!
//! A batch is one connected frame of fixed-length rods, or many small frames. Its rods are coloured so that rods of one
//! colour share no moving sphere. A sweep goes through the batch colour by colour. Sweeps end when every relative error is
//! at most 1e-5 or is a rounding error. There are at most 400 sweeps.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::RESTORING;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, along_axis, rattle, shake};
use crate::step::moves::NONE;
use crate::step::stage::{Access, Binding, Slot, Stage, read};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "constrain",
    wgsl: Wgsl::File(part!("step/integrate/constrain.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Write },
        read("y3", Buffer::Y3),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Batches,
    moves: |_| NONE,
    cpu: constrain,
};

fn constrain(world: &mut World, pass: u32) {
    let restores = pass == RESTORING;
    if world.status.rejected != 0 || (restores && world.status.lengths_due == 0) {
        return;
    }
    let World { step, topology, states: [start, _, old, y4], .. } = world;
    let state = if pass == 3 { y4 } else { start };
    for batch in 0..step.layout.batches {
        let batch = Batch::new(step, topology, batch);
        if restores {
            batch.sweep(step, state, |ends, _| along_axis(ends));
            continue;
        }
        let was = |end: u32| old[end as usize].truncate();
        batch.sweep(step, state, |ends, [one, two]| shake(ends, was(two) - was(one), step.constants.dt));
        batch.sweep(step, state, |ends, _| rattle(ends, step.constants.dt));
    }
}
