//! Symplectic Euler: v += dt a(x, v), L += dt T, x += dt v (docs/physics.md section 5.2). The new state goes to `Y2`.
//!
//! In scenes with rods the stage leaves the old position in region 0 of `Y3` and the new spin in region 2. Like `advance`,
//! it counts contacts, rejects the step if a sphere is outside its AABB, and reports spheres whose state is not finite.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::{Tally, count_builds};
use crate::model::dispatch::Threads;
use crate::model::layout::LAW_THESIS;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::net_force::count_contacts;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::physics::travel::escape_ratio;
use crate::step::moves::{FORCES, Moves};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "symplectic_euler",
    wgsl: Wgsl::File(part!("step/integrate/symplectic_euler.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        write("y3", Buffer::Y3),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // Reads 3 rows, writes 3.
    moves: |_| Moves { rows: 6, sphere_aabbs: 1, ..FORCES },
    cpu: symplectic_euler,
};

fn symplectic_euler(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    count_builds(&mut world.status);
    let [start, y2, y3, _] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start).at_evaluation(&world.status, 0).with_laws(&world.user_laws);
    let lists = Lists::new(&world.step, &world.lists);
    let dt = world.step.dt;
    let next = |sphere: u32, tally: &mut Tally| {
        let y = Motion::of(&view, sphere);
        if view.is_fixed(sphere) {
            if world.step.law == LAW_THESIS {
                count_contacts(&view, &lists, sphere, tally);
            }
            return y;
        }
        tally.escape_ratio = tally.escape_ratio.max(escape_ratio(&view, &world.aabbs, sphere));
        let Rates { acceleration, torque } = sphere_rates(&view, &lists, &world.wrenches, sphere, Some(&mut *tally));
        let velocity = y.velocity + dt * acceleration;
        let (position, low) = y.moved(dt * velocity);
        let next = Motion { position, low, velocity, angular_momentum: y.angular_momentum + dt * torque };
        next.or_stopped(&y, BadStage::Forces1, view.insertion_index(sphere), tally)
    };
    let tally = Rows::of(y2, world.step.spheres)
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
}
