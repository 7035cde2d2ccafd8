//! RK4, pass 3: the new state (docs/physics section 5.1), and without rods and rigid bodies the new orientations.
//!
//! `y' = y + [(Y2 - y) + 2 (Y3 - y) + (Y4 - y)] / 3 + dt/6 f(Y4)`. The stage states contain the earlier rates, so no running
//! sum of them is needed. With residues the last of them holds that sum, because stage states are rounded. Positions get the same mean of the velocities of the stage states, so that their low parts are kept.
//!
//! The mean spin is (w1 + 2 w2 + 2 w3 + w4) / 6. In scenes without rods and rigid bodies it rotates the sphere (exponential map, docs/physics
//! section 5.3). In others the stage leaves it in region 2 of `Y3`, and the old position in region 0, for `constrain` and `turn`.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, SLICE};
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::step::integrate::turn::turn_for;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "finish",
    wgsl: Wgsl::File(part!("step/integrate/finish.wgsl")),
    bindings: &[
        read("state", Buffer::Y4),
        read("y2", Buffer::Y2),
        write("y3", Buffer::Y3),
        write("start", Buffer::Start),
        read("topology", Buffer::Topology),
        read("wrenches", Buffer::Wrenches),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows of four states and the load; writes 3 rows; reads and writes the orientation.
    moves: |_| Moves { rows: 19, residues: 4, ..NONE },
    cpu: finish,
};

fn finish(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let done = finish_all(world);
    let step = &world.step;
    if !step.traits().turns_late() {
        let turning = world.orientations.par_iter_mut().zip(&done).with_min_len(GRAIN);
        turning.for_each(|(orientation, done)| turn_for(orientation, done.spin, step.constants.dt));
        return;
    }
    Rows::of(&mut world.states[2], step.layout.spheres).for_each(|mut memory| {
        for sphere in memory.spheres() {
            let Finished { old_position, spin } = done[sphere as usize];
            memory.remember(sphere, old_position, spin);
        }
    });
}

/// Data of a sphere for the later stages of the step.
#[derive(Clone, Copy, Default)]
struct Finished {
    old_position: Vec3,
    /// The mean spin over the step, in rad/s.
    spin: Vec3,
}

/// Computes the new state of all spheres.
fn finish_all(world: &mut World) -> Vec<Finished> {
    let [start, y2, y3, y4] = &mut world.states;
    let views = [&*y2, y3, y4].map(|state| {
        View::new(&world.step, &world.topology, state).at_evaluation(&world.status, 3).with_laws(&world.user_laws)
    });
    let mut all = vec![Finished::default(); world.step.layout.spheres as usize];
    let tally = Rows::of(start, world.step.layout.spheres)
        .zip(all.par_chunks_mut(SLICE as usize))
        .map(|(mut rows, all)| {
            let mut tally = Tally::default();
            for (sphere, done) in rows.spheres().zip(all) {
                let start = rows.get(sphere);
                let rates = || sphere_rates(&views[2], &world.wrenches, sphere);
                let (motion, spin) = finished(start, &views, sphere, rates, &mut tally);
                rows.set(&views[2], sphere, motion);
                *done = Finished { old_position: start.position, spin };
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    all
}

/// The new state of a sphere, and its mean spin over the step.
#[inline]
pub(crate) fn finished(
    y: Motion,
    views: &[View; 3],
    sphere: u32,
    rates: impl FnOnce() -> Rates,
    tally: &mut Tally,
) -> (Motion, Vec3) {
    let [y2, y3, y4] = views.map(|view| Motion::of(&view, sphere));
    let last = &views[2];
    let [w1, w2, w3, w4] = [y, y2, y3, y4].map(|motion| motion.angular_momentum * last.inverse_inertia(sphere));
    if last.is_fixed(sphere) {
        return (y, w1);
    }
    let spin = (w1 + 2.0 * w2 + 2.0 * w3 + w4) / 6.0;
    let Rates { acceleration, torque } = rates();
    let dt = last.step.constants.dt;
    let changes = |y: Vec3, y2: Vec3, y3: Vec3, y4: Vec3| (y2 - y) + 2.0 * (y3 - y) + (y4 - y);
    // y' = y + [(Y2 - y) + 2 (Y3 - y) + (Y4 - y)] / 3 + dt/6 k4. The stage states hold k1, k2 and k3.
    let mean = |y: Vec3, y2: Vec3, y3: Vec3, y4: Vec3, k4: Vec3| y + changes(y, y2, y3, y4) / 3.0 + (dt / 6.0) * k4;
    // The rates of positions are the velocities of the stage states: x' = x + dt/6 (v + 2 v2 + 2 v3 + v4).
    let later = [y2, y3, y4].map(|motion| motion.velocity - y.velocity);
    let (position, low) = y.moved(dt * (y.velocity + (2.0 * (later[0] + later[1]) + later[2]) / 6.0));
    let motion = if last.step.has_residues() {
        let [of_velocity, of_momentum] = last.increments(sphere);
        y.increased(last.step, [of_velocity + (dt / 6.0) * acceleration, of_momentum + (dt / 6.0) * torque])
    } else {
        Motion {
            velocity: mean(y.velocity, y2.velocity, y3.velocity, y4.velocity, acceleration),
            angular_momentum: mean(y.angular_momentum, y2.angular_momentum, y3.angular_momentum, y4.angular_momentum, torque),
            ..y
        }
    };
    let motion = Motion { position, low, ..motion };
    (motion.or_stopped(&y, BadStage::Forces4, last.insertion_index(sphere), tally), spin)
}
