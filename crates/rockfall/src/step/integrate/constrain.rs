//! Fixed lengths after the integration: SHAKE along the old directions, then RATTLE (docs/physics.md section 5.4).
//!
//! A batch is one connected frame of fixed-length rods (or many small ones); its rods are coloured so that those of one
//! colour share no sphere. Swept colour by colour until every length is within 1e-5, or its error is rounding, at most 400 times.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::lengths::{Batch, rattle, shake};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "constrain",
    wgsl: Wgsl::File(part!("step/integrate/constrain.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("y3", Buffer::Y3),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Batches,
    cpu: constrain,
};

fn constrain(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [state, _, old, _], .. } = world;
    for batch in 0..step.batches {
        let batch = Batch::new(step, topology, batch);
        let was = |end: u32| old[end as usize].truncate();
        batch.sweep(step, state, |ends, [one, two]| shake(ends, was(two) - was(one), step.dt));
        batch.sweep(step, state, |ends, _| rattle(ends, step.dt));
    }
}
