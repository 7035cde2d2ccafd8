//! Velocity Verlet: half a kick with the rates of the last force evaluation, then the drift: v += dt/2 a, L += dt/2 T, x += dt v
//! (docs/physics.md section 5.7). The result goes to `Y4`, where the forces are evaluated next.
//!
//! In scenes with rods the stage leaves the old position in region 0 of `Y3` and the spin in region 2. It rejects the step if a
//! sphere is outside its AABB before or after the drift, requests new lists (`rebuild`) if a sphere may leave its AABB within the
//! next step, and reports spheres whose state is not finite. In scenes with rods of fixed length `constrain` then changes the
//! positions, so `check_drift` makes the second of these tests.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::{Tally, count_builds};
use crate::model::dispatch::Threads;
use crate::model::layout::{GRAIN, RATE_WORDS};
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::status::REBUILD_REQUESTED;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::{escape_ratio, needs_rebuild, outside};
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
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads 3 rows, writes 3.
    moves: |_| Moves { rows: 6, rates: 1, sphere_aabbs: 1, ..NONE },
    cpu: drift,
};

fn drift(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    count_builds(&mut world.status);
    let [start, _, y3, y4] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start);
    let dt = view.step.dt;
    let next = |sphere: u32, tally: &mut Tally| {
        let y = Motion::of(&view, sphere);
        if view.is_fixed(sphere) {
            return y;
        }
        tally.escape_ratio = tally.escape_ratio.max(escape_ratio(&view, &world.aabbs, sphere));
        let at = (view.insertion_index(sphere) * RATE_WORDS) as usize;
        let [acceleration, torque] = [at, at + 3].map(|at| Vec3::from_slice(&world.rates[at..]));
        let velocity = y.velocity + 0.5 * dt * acceleration;
        let angular_momentum = y.angular_momentum + 0.5 * dt * torque;
        let (position, low) = y.moved(dt * velocity);
        let next = Motion { position, low, velocity, angular_momentum };
        let next = next.or_stopped(&y, BadStage::Forces1, view.insertion_index(sphere), tally);
        if view.step.rods == 0 {
            let aabb = &world.aabbs[sphere as usize];
            tally.escape_ratio = tally.escape_ratio.max(outside(view.step, aabb, next.position, view.radius(sphere)));
        }
        next
    };
    let tally = Rows::of(y4, world.step.spheres)
        .zip(Rows::of(y3, world.step.spheres))
        .map(|(mut rows, mut memory)| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                let next = next(sphere, &mut tally);
                rows.set(&view, sphere, next);
                if view.step.rods > 0 {
                    memory.remember(sphere, view.position(sphere), next.angular_momentum * view.inverse_inertia(sphere));
                }
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    if world.step.rods == 0 {
        request_rebuild(world);
    }
}

/// Requests new lists if a sphere may leave its AABB after the drift.
pub(super) fn request_rebuild(world: &mut World) {
    let view = View::new(&world.step, &world.topology, &world.states[3]);
    let leaves = |sphere| needs_rebuild(&view, &world.aabbs, sphere, view.position(sphere), view.velocity(sphere));
    if (0..world.step.spheres).into_par_iter().with_min_len(GRAIN).any(leaves) {
        world.status.rebuild |= REBUILD_REQUESTED;
    }
}
