//! RK4, pass 3: the last force evaluation and the new state, without a running sum:
//! y + [(Y2 - y) + 2 (Y3 - y) + (Y4 - y)] / 3 + dt/6 f(Y4).
//!
//! Leaves the old position in region 0 of `Y3` and the mean spin (w1 + 2 w2 + 2 w3 + w4) / 6 in its region 2, for `constrain`
//! and `turn`; where there are no rods, and so neither of them, `finish_and_turn` does it all.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::forces::rates;
use crate::cpu::lists::Lists;
use crate::cpu::state::{Motion, Rows};
use crate::cpu::tally::Tally;
use crate::cpu::view::View;
use crate::layout::BadStage;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "finish",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/wrenches.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("wgsl/finished.wgsl"),
        part!("stage/finish.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Y4),
        read("y2", Buffer::Y2),
        write("y3", Buffer::Y3),
        write("start", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("wrenches", Buffer::Wrenches),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: finish,
};

fn finish(world: &mut World, _pass: u32) {
    if world.status.void != 0 {
        return;
    }
    let done = finish_all(world);
    for ((_, memory), done) in Rows::of(&mut world.states[2], world.step.spheres).into_iter().zip(done) {
        memory.remember(done.old_position, done.spin);
    }
}

/// A sphere after the step, and what the rest of it needs to know.
pub(super) struct Done {
    motion: Motion,
    old_position: Vec3,
    /// The mean over the step, in rad/s.
    pub(super) spin: Vec3,
}

/// Makes the new state of all spheres.
pub(super) fn finish_all(world: &mut World) -> Vec<Done> {
    let [start, y2, y3, y4] = &mut world.states;
    let views = [&*start, y2, y3, y4].map(|state| View::new(&world.step, &world.words, state));
    let lists = Lists::new(&world.step, &world.lists);
    let (done, tallies): (Vec<Done>, Vec<Tally>) = (0..world.step.spheres)
        .into_par_iter()
        .with_min_len(GRAIN)
        .map(|sphere| {
            let mut tally = Tally::default();
            (finished(&views, &lists, &world.wrenches, sphere, &mut tally), tally)
        })
        .unzip();
    for ((_, row), done) in Rows::of(start, world.step.spheres).into_iter().zip(&done) {
        row.put(done.motion);
    }
    tallies.into_iter().fold(Tally::default(), Tally::merge).tell(&mut world.status);
    done
}

fn finished(views: &[View; 4], lists: &Lists, wrenches: &[Vec4], sphere: u32, tally: &mut Tally) -> Done {
    let [y, y2, y3, y4] = views.map(|view| Motion::of(&view, sphere));
    let [w1, w2, w3, w4] = views.map(|view| view.spin(sphere));
    let spin = (w1 + 2.0 * w2 + 2.0 * w3 + w4) / 6.0;
    let last = &views[3];
    if last.is_fixed(sphere) {
        return Done { motion: y, old_position: y.position, spin: w1 };
    }
    let (acceleration, torque) = rates(last, lists, wrenches, sphere, None);
    let h = last.step.dt / 6.0;
    // y' = y + [(Y2 - y) + 2 (Y3 - y) + (Y4 - y)] / 3 + h/6 k4: the stage states hold k1, k2, k3.
    let mean = |y: Vec3, y2: Vec3, y3: Vec3, y4: Vec3, k4: Vec3| y + ((y2 - y) + 2.0 * (y3 - y) + (y4 - y)) / 3.0 + h * k4;
    let motion = Motion {
        position: mean(y.position, y2.position, y3.position, y4.position, y4.velocity),
        velocity: mean(y.velocity, y2.velocity, y3.velocity, y4.velocity, acceleration),
        angular_momentum: mean(y.angular_momentum, y2.angular_momentum, y3.angular_momentum, y4.angular_momentum, torque),
    };
    Done { motion: motion.or_stopped(y.position, BadStage::Forces4, last.user(sphere), tally), old_position: y.position, spin }
}
