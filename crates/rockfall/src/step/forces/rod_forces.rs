//! Computes the contact forces on rods and shares them between the two ends of each rod (docs/physics.md section 4).
//!
//! The first pass clears `lengths_due`. The pass that counts contacts, `Step::counted_pass`, also counts those of rods with
//! objects of higher id. Nothing is done in a rejected step, nor in pass 0 of velocity Verlet unless `forces_due` is set.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::net_force::rod_loads;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "rod_forces",
    wgsl: Wgsl::File(part!("step/forces/rod_forces.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        write("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Rods,
    moves: |_| Moves { rods: 1, wrenches: 1, ..NONE },
    cpu: rod_forces,
};

fn rod_forces(world: &mut World, pass: u32) {
    if world.status.rejected != 0 || world.step.rods == 0 {
        return;
    }
    if pass == 0 {
        world.status.lengths_due = 0;
    }
    if !world.needs_forces(pass) {
        return;
    }
    let counts = pass == world.step.counted_pass();
    let view = View::new(&world.step, &world.topology, &world.states[pass as usize]);
    let lists = Lists::new(&world.step, &world.lists);
    let tally = world
        .wrenches
        .par_chunks_mut(4)
        .with_min_len(GRAIN)
        .take(world.step.rods as usize)
        .enumerate()
        .map(|(rod, wrench)| {
            let mut tally = Tally::default();
            let [one, two] = rod_loads(&view, &lists, rod as u32, counts.then_some(&mut tally));
            let loads = [one.force, one.torque, two.force, two.torque];
            wrench.copy_from_slice(&loads.map(|load| load.extend(0.0)));
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}
