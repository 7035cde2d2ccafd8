//! RK4, passes 0 to 2: corrects the velocities of a new stage state, so that the forces of a stage change no fixed length
//! (docs/physics.md section 5.4).
//!
//! Pass p corrects Y(p+2), which `advance` has computed from the rates at Y(p+1). The last evaluation needs no correction, because
//! `constrain` follows it.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, hold, relative_motion};
use crate::step::moves::NONE;
use crate::step::stage::{Access, Binding, Slot, Stage, read};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "constrain_rates",
    wgsl: Wgsl::File(part!("step/integrate/constrain_rates.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::Next, access: Access::Write },
        Binding { name: "evaluated", slot: Slot::State, access: Access::Read },
        read("start", Buffer::Start),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Batches,
    moves: |_| NONE,
    cpu: constrain_rates,
};

fn constrain_rates(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states, .. } = world;
    let time = step.dt * [0.5, 0.5, 1.0][pass as usize];
    let (done, todo) = states.split_at_mut(pass as usize + 1);
    let (start, evaluated, next) = (&done[0], &done[pass as usize], &mut todo[0]);
    for batch in 0..step.batches {
        Batch::new(step, topology, batch).sweep(step, next, |ends, rod| {
            let (_, before) = relative_motion(step, start, rod);
            hold(ends, relative_motion(step, evaluated, rod), before, time, step.dt)
        });
    }
}
