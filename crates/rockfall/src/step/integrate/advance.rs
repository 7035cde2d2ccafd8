//! RK4, passes 0 to 2: computes the net force on every sphere, and from it the next stage state (docs/physics.md sections 4
//! and 5.1).
//!
//! Pass p evaluates the rates f at stage state Y(p+1) and writes Y(p+2) = y + c f, where c is dt/2, dt/2 and dt in passes
//! 0, 1 and 2. Pass 0 counts contacts. A sphere whose next stage state is not finite gets its starting position, no
//! velocity and no spin in that state, and is reported.
//!
//! Pass 2 rejects the step if a stage state of a sphere is outside its AABB. It requests new lists (`rebuild`) if a sphere
//! may leave its AABB within the next step. This test uses stage state 4, which is close to the state at the end of the
//! step.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::{Tally, count_builds};
use crate::model::dispatch::Threads;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::step::Aabb;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::net_force::count_contacts;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::physics::travel::{needs_rebuild, outside};
use crate::step::moves::{FORCES, Moves};
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
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // Reads 3 rows, writes 3. Later passes also read the 3 rows of the starting state, and the last one AABBs.
    moves: |pass| Moves { rows: if pass == 0 { 6 } else { 9 }, sphere_aabbs: u64::from(pass == 2), ..FORCES },
    cpu: advance,
};

const BAD: [BadStage; 3] = [BadStage::Forces1, BadStage::Forces2, BadStage::Forces3];

fn advance(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    if pass == 0 {
        count_builds(&mut world.status);
    }
    let (done, todo) = world.states.split_at_mut(pass as usize + 1);
    let start = View::new(&world.step, &world.topology, &done[0]);
    let view = View::new(&world.step, &world.topology, &done[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let lists = Lists::new(&world.step, &world.lists);
    let next = |sphere: u32, tally: &mut Tally| {
        let origin = Motion::of(&start, sphere);
        if view.is_fixed(sphere) {
            if pass == 0 {
                count_contacts(&view, &lists, sphere, tally);
            }
            return origin;
        }
        let rates = sphere_rates(&view, &lists, &world.wrenches, sphere, (pass == 0).then_some(&mut *tally));
        next_state(&start, &view, &world.aabbs, pass, sphere, &rates, tally)
    };
    // Stage states have low parts of positions only where geometry uses them.
    let regions = if world.step.is_double() { 4 } else { 3 };
    let stage = &mut todo[0][..(regions * world.step.spheres) as usize];
    let tally = Rows::of(stage, world.step.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                rows.set(&start, sphere, next(sphere, &mut tally));
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}

/// The next stage state of a moving sphere, from its rates of change in the evaluated one.
#[inline]
pub(crate) fn next_state(
    start: &View,
    view: &View,
    aabbs: &[Aabb],
    pass: u32,
    sphere: u32,
    rates: &Rates,
    tally: &mut Tally,
) -> Motion {
    let (origin, dt) = (Motion::of(start, sphere), view.step.dt);
    let h = dt * [0.5, 0.5, 1.0][pass as usize];
    let by = h * view.velocity(sphere);
    let (position, low) = if view.step.is_double() { origin.moved(by) } else { (origin.position + by, Vec3::ZERO) };
    let next = Motion {
        position,
        low,
        velocity: origin.velocity + h * rates.acceleration,
        angular_momentum: origin.angular_momentum + h * rates.torque,
    };
    let next = next.or_stopped(&origin, BAD[pass as usize], view.insertion_index(sphere), tally);
    if pass == 2 {
        // All four stage states are checked here, before the step changes the state. So a rejected step leaves it as it was.
        let second = origin.position + 0.5 * dt * origin.velocity;
        let second = if second.is_finite() { second } else { origin.position };
        for position in [origin.position, second, view.position(sphere), next.position] {
            let escaped = outside(view.step, &aabbs[sphere as usize], position, view.radius(sphere));
            tally.escape_ratio = tally.escape_ratio.max(escaped);
        }
        tally.rebuild |= needs_rebuild(view, aabbs, sphere, next.position, next.velocity);
    }
    next
}
