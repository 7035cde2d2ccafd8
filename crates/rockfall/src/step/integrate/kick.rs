//! Velocity Verlet: completes the kick with the loads after the drift: v += dt/2 a, L += dt/2 T (docs/physics section 5.7).
//! Keeps the rates for the next step and clears `forces_due`. Reports spheres whose state is not finite. In scenes without rods and rigid bodies it
//! rotates every sphere by its spin in the middle of the step (exponential map, docs/physics section 5.3).

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, RATE_WORDS, SLICE};
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "kick",
    wgsl: Wgsl::File(part!("step/integrate/kick.wgsl")),
    bindings: &[
        read("state", Buffer::Y4),
        Binding { name: "start", slot: Slot::Ended, access: Access::Write },
        read("topology", Buffer::Topology),
        read("wrenches", Buffer::Wrenches),
        Binding { name: "kept_rates", slot: Slot::EndedRates, access: Access::Write },
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows and the load; writes 3 rows; reads and writes the orientation.
    moves: |_| Moves { rows: 10, rates: 1, residues: 2, ..NONE },
    cpu: kick,
};

fn kick(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let spins = kick_all(world, pass);
    if !world.step.traits().turns_late() {
        let turning = world.orientations.par_iter_mut().zip(&spins).with_min_len(GRAIN);
        turning.for_each(|(orientation, spin)| turn_for(orientation, *spin, world.step.constants.dt));
    }
}

/// Computes the new state of all spheres, and returns their spins in the middle of the step.
fn kick_all(world: &mut World, pass: u32) -> Vec<Vec3> {
    let [start, .., y4] = &mut world.states;
    let view = View::new(&world.step, &world.topology, y4).at_evaluation(&world.status, pass).with_laws(&world.user_laws);
    let mut all = vec![(None, Vec3::ZERO); world.step.layout.spheres as usize];
    let kick = |sphere: u32, old: Motion, tally: &mut Tally| {
        let y = Motion::of(&view, sphere);
        if !view.is_integrated(sphere) {
            return (old, (None, view.spin(sphere)));
        }
        let rates = sphere_rates(&view, &world.wrenches, sphere);
        let half = 0.5 * view.step.constants.dt;
        let next = y.increased(view.step, [half * rates.acceleration, half * rates.torque]);
        if next.is_finite() {
            return (next, (Some(rates), view.spin(sphere)));
        }
        let stopped = next.or_stopped(&old, BadStage::Forces2, view.insertion_index(sphere), tally);
        (stopped, (Some(Rates { acceleration: Vec3::ZERO, torque: Vec3::ZERO }), Vec3::ZERO))
    };
    let tally = Rows::of(start, world.step.layout.spheres)
        .zip(all.par_chunks_mut(SLICE as usize))
        .map(|(mut rows, all)| {
            let mut tally = Tally::default();
            for (sphere, done) in rows.spheres().zip(all) {
                let (next, kept) = kick(sphere, rows.get(sphere), &mut tally);
                rows.set(&view, sphere, next);
                *done = kept;
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    world.status.forces_due = 0;
    let (rates, spins): (Vec<Option<Rates>>, Vec<Vec3>) = all.into_iter().unzip();
    put_rates(world, &rates);
    spins
}

/// Keeps the rates of the spheres, given by memory slot.
fn put_rates(world: &mut World, rates: &[Option<Rates>]) {
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    for (sphere, rates) in rates.iter().enumerate() {
        if let Some(Rates { acceleration, torque }) = rates {
            let at = (view.insertion_index(sphere as u32) * RATE_WORDS) as usize;
            acceleration.write_to_slice(&mut world.rates[at..]);
            torque.write_to_slice(&mut world.rates[at + 3..]);
        }
    }
}
