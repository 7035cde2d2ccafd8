//! Velocity Verlet: half a kick with the rates of the last force evaluation, then the drift: v += dt/2 a, L += dt/2 T, x += dt v
//! (docs/physics section 5.7). The result goes to `Y4`, where the forces are evaluated next. If `forces_due` is set, the rates
//! follow from the loads at the start of the step instead.
//!
//! In scenes with rods or rigid bodies the stage leaves the old position in region 0 of `Y3` and the spin in region 2. It reports spheres whose
//! state is not finite.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::RATE_WORDS;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "drift",
    wgsl: Wgsl::File(part!("step/integrate/drift.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y4),
        write("y3", Buffer::Y3),
        read("topology", Buffer::Topology),
        read("kept_rates", Buffer::Rates),
        read("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows, writes 3.
    moves: |_| Moves { rows: 6, rates: 1, residues: 2, ..NONE },
    cpu: drift,
};

fn drift(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let [start, _, y3, y4] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start).at_evaluation(&world.status, pass).with_laws(&world.user_laws);
    let dt = view.step.constants.dt;
    let turns_late = world.step.traits().turns_late();
    let are_due = world.status.forces_due != 0;
    let kept_rates = |sphere: u32| {
        let at = (view.insertion_index(sphere) * RATE_WORDS) as usize;
        let [acceleration, torque] = [at, at + 3].map(|at| Vec3::from_slice(&world.rates[at..]));
        Rates { acceleration, torque }
    };
    let next = |sphere: u32, tally: &mut Tally| {
        let y = Motion::of(&view, sphere);
        if !view.is_integrated(sphere) {
            return y;
        }
        let Rates { acceleration, torque } =
            if are_due { sphere_rates(&view, &world.wrenches, sphere) } else { kept_rates(sphere) };
        let kicked = y.drifted(view.step, [0.5 * dt * acceleration, 0.5 * dt * torque]);
        let (position, low) = kicked.moved(dt * kicked.velocity);
        let next = Motion { position, low, ..kicked };
        next.or_stopped(&y, BadStage::Forces1, view.insertion_index(sphere), tally)
    };
    let tally = Rows::of(y4, world.step.layout.spheres)
        .zip(Rows::of(y3, world.step.layout.spheres))
        .map(|(mut rows, mut memory)| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                let next = next(sphere, &mut tally);
                rows.set(&view, sphere, next);
                if turns_late {
                    memory.remember(sphere, view.position(sphere), next.angular_momentum * view.inverse_inertia(sphere));
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}
