//! Corrects the lengths of fixed-length rods after the integration: SHAKE along the old directions, then RATTLE
//! (docs/physics.md section 5.4).
//!
//! A batch is one connected frame of fixed-length rods, or many small frames. Its rods are coloured so that rods of one
//! colour share no moving sphere. A sweep goes through the batch colour by colour. Sweeps end when every relative error is
//! at most 1e-5 or is a rounding error. There are at most 400 sweeps.
//!
//! Pass 0 corrects the state. Velocity Verlet also corrects `Y4`, the state after the drift, in pass 3.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, rattle, shake};
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
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [start, _, old, y4], .. } = world;
    let state = if pass == 0 { start } else { y4 };
    for batch in 0..step.batches {
        let batch = Batch::new(step, topology, batch);
        let was = |end: u32| old[end as usize].truncate();
        batch.sweep(step, state, |ends, [one, two]| shake(ends, was(two) - was(one), step.dt));
        batch.sweep(step, state, |ends, _| rattle(ends, step.dt));
    }
}
