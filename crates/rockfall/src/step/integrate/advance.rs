//! RK4, passes 0 to 2: computes the next stage state of every sphere from its load (docs/physics section 5.1).
//!
//! Pass p takes the rates f at stage state Y(p+1) and writes Y(p+2) = y + c f, where c is dt/2, dt/2 and dt in passes 0, 1
//! and 2. A sphere whose next stage state is not finite gets its starting position, no velocity and no spin in that state, and
//! is reported.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, RESIDUE_REGION};
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "advance",
    wgsl: Wgsl::File(part!("step/integrate/advance.wgsl")),
    bindings: &[
        Binding { name: "state", slot: Slot::State, access: Access::Read },
        read("start", Buffer::Start),
        Binding { name: "next", slot: Slot::Next, access: Access::Write },
        read("topology", Buffer::Topology),
        read("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows and the load, writes 3. Later passes also read the 3 rows of the starting state.
    // With residues, it writes the increments so far, and later passes read them.
    moves: |pass| {
        let (rows, residues) = if pass == 0 { (8, 2) } else { (11, 4) };
        Moves { rows, residues, ..NONE }
    },
    cpu: advance,
};

const BAD: [BadStage; 3] = [BadStage::Forces1, BadStage::Forces2, BadStage::Forces3];

fn advance(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let (done, todo) = world.states.split_at_mut(pass as usize + 1);
    let start = View::new(&world.step, &world.topology, &done[0]);
    let view = View::new(&world.step, &world.topology, &done[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let next = |sphere: u32, tally: &mut Tally| {
        if view.is_fixed(sphere) {
            return Motion::of(&start, sphere);
        }
        next_state(&start, &view, pass, sphere, &sphere_rates(&view, &world.wrenches, sphere), tally)
    };
    // Stage states have low parts of positions only where geometry uses them.
    let regions = if world.step.is_double() { 4 } else { 3 };
    let stage = &mut todo[0][..(regions * world.step.layout.spheres) as usize];
    let tally = Rows::of(stage, world.step.layout.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                rows.set(&start, sphere, next(sphere, &mut tally));
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    if world.step.has_residues() {
        put_increments(world, pass);
    }
}

/// Writes what the evaluations up to this pass add to velocity and angular momentum of every sphere in the step. Stage states alone
/// would lose it by rounding (docs/physics section 5.10).
fn put_increments(world: &mut World, pass: u32) {
    let (done, todo) = world.states.split_at_mut(pass as usize + 1);
    let view = View::new(&world.step, &world.topology, &done[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let sixth = view.step.constants.dt / 6.0;
    let weight = if pass == 0 { sixth } else { 2.0 * sixth };
    let n = world.step.layout.spheres as usize;
    let (of_velocities, of_momenta) = todo[0][RESIDUE_REGION as usize * n..].split_at_mut(n);
    let rows = of_velocities.par_iter_mut().zip(of_momenta).enumerate().with_min_len(GRAIN);
    rows.for_each(|(sphere, (of_velocity, of_momentum))| {
        let sphere = sphere as u32;
        if !view.is_fixed(sphere) {
            let before = if pass == 0 { [Vec3::ZERO; 2] } else { view.increments(sphere) };
            let Rates { acceleration, torque } = sphere_rates(&view, &world.wrenches, sphere);
            *of_velocity = (before[0] + weight * acceleration).extend(0.0);
            *of_momentum = (before[1] + weight * torque).extend(0.0);
        }
    });
}

/// The next stage state of a moving sphere, from its rates of change in the evaluated one.
#[inline]
pub(crate) fn next_state(start: &View, view: &View, pass: u32, sphere: u32, rates: &Rates, tally: &mut Tally) -> Motion {
    let (origin, dt) = (Motion::of(start, sphere), view.step.constants.dt);
    let h = dt * [0.5, 0.5, 1.0][pass as usize];
    let by = h * view.velocity(sphere);
    let (position, low) = if view.step.is_double() { origin.moved(by) } else { (origin.position + by, Vec3::ZERO) };
    let next = Motion {
        position,
        low,
        velocity: origin.velocity + h * rates.acceleration,
        angular_momentum: origin.angular_momentum + h * rates.torque,
        ..origin
    };
    next.or_stopped(&origin, BAD[pass as usize], view.insertion_index(sphere), tally)
}
