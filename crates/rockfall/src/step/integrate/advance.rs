//! RK4, passes 0 to 2: net force on every sphere, and the next stage state from it (physics.md sections 4, 5).
//!
//! With f the right side at stage state Y(p+1): Y(p+2) = y + c f, c = dt/2, dt/2, dt. Pass 0 counts contacts. A sphere
//! of which a stage state is outside of its AABB voids the step, in pass 2; one whose next state is not finite gets its
//! starting position, no velocity and no spin there, and is reported. In pass 2 a sphere that may leave its AABB within the
//! next step asks for new lists (`rebuild`): its stage state 4 is about where this step will end.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::{Tally, count_builds};
use crate::model::dispatch::Threads;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::forces::net_force::count_contacts;
use crate::physics::forces::rates::Rates;
use crate::physics::forces::sphere_rates;
use crate::physics::travel::{needs_rebuild, outside};
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
    let view = View::new(&world.step, &world.topology, &done[pass as usize]);
    let lists = Lists::new(&world.step, &world.lists);
    let h = world.step.dt * [0.5, 0.5, 1.0][pass as usize];
    let next = |sphere: u32, tally: &mut Tally| {
        let origin = Motion::of(&start, sphere);
        if view.is_fixed(sphere) {
            if pass == 0 {
                count_contacts(&view, &lists, sphere, tally);
            }
            return origin;
        }
        let Rates { acceleration, torque } =
            sphere_rates(&view, &lists, &world.wrenches, sphere, (pass == 0).then_some(&mut *tally));
        let next = Motion {
            position: origin.position + h * view.velocity(sphere),
            velocity: origin.velocity + h * acceleration,
            angular_momentum: origin.angular_momentum + h * torque,
        };
        let next = next.or_stopped(origin.position, BAD[pass as usize], view.user(sphere), tally);
        if pass == 2 {
            // All four stage states at once, in time for a void step to be nobody's state.
            let second = origin.position + 0.5 * world.step.dt * origin.velocity;
            let second = if second.is_finite() { second } else { origin.position };
            for position in [origin.position, second, view.position(sphere), next.position] {
                let escaped = outside(&world.aabbs[sphere as usize], position, view.radius(sphere));
                tally.escape_ratio = tally.escape_ratio.max(escaped);
            }
            tally.rebuild |= needs_rebuild(&view, &world.aabbs, sphere, next.position, next.velocity);
        }
        next
    };
    let tally = Rows::of(&mut todo[0], world.step.spheres)
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
