//! Applies the impulses of collisions to rigid bodies (docs/physics.md section 3.11). They change the velocity and the angular momentum of a
//! body, and with them the velocities and spins of its spheres. Nothing is displaced.
//!
//! The stage follows `commit_collisions`. The thread of the first sphere of a body does all of it: it reads the records of the collisions, and of
//! the state only the positions of its own spheres. A body whose new state is not finite stops, and its first sphere is reported.

use glam::{Vec3, Vec4};

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::impulse::BodyPush;
use crate::model::layout::RIGID_ROWS;
use crate::model::part::part;
use crate::model::rigid::Pose;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::needs_rebuild;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "push_bodies",
    wgsl: Wgsl::File(part!("step/bodies/push_bodies.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        write("bodies", Buffer::RigidBodies),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: push_bodies,
};

fn push_bodies(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 2 {
        return;
    }
    for push in std::mem::take(&mut world.pushes) {
        apply(world, &push);
    }
}

fn apply(world: &mut World, push: &BodyPush) {
    let rows = &mut world.rigid_bodies[(push.body * RIGID_ROWS) as usize..][..Pose::ROWS];
    let before = Pose::of(rows);
    let mut after =
        Pose { velocity: before.velocity + push.velocity, momentum: before.momentum + push.angular_momentum, ..before };
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let mut tally = Tally::default();
    if !after.is_finite() {
        after = Pose { velocity: Vec3::ZERO, momentum: Vec3::ZERO, ..before };
        view.members(view.rigid_body(push.body)).take(1).for_each(|(index, _)| tally.count_bad(BadStage::Collisions, index));
    }
    rows.copy_from_slice(&after.rows());
    let placed: Vec<(u32, [Vec4; 4])> = view.placed(push.body, after).collect();
    let n = world.step.layout.spheres as usize;
    for (sphere, [_, velocity, momentum, _]) in placed {
        let slot = sphere as usize;
        let state = &mut world.states[0];
        let change = velocity - state[n + slot];
        (state[n + slot], state[2 * n + slot]) = (velocity, momentum);
        let mut present = velocity;
        if world.step.is_half_step() {
            state[4 * n + slot] += change;
            present = state[4 * n + slot];
        }
        let view = View::new(&world.step, &world.topology, &world.states[0]);
        tally.rebuild |= needs_rebuild(&view, &world.aabbs, sphere, view.position(sphere), present.truncate());
    }
    tally.add_to(&mut world.status);
}
