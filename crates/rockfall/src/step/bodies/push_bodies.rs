//! Applies impulses to rigid bodies (docs/physics sections 3.9 and 3.11). They change the velocity and the angular momentum of a body. A lone
//! collision also displaces and turns it, as it has moved since its time of contact.
//!
//! Pass 0 follows `commit_collisions`. The thread of the first sphere of a body reads the records of its collisions, and of the state only
//! the positions of its own spheres. It also counts the pressed contacts that touch the body, for the friction impulses. Pass [`RUBBED`] follows `apply_friction_impulses`, which has summed the friction impulses on each sphere
//! of the body. The thread marks the body in [`PUSHED_ROW`], so that [`AFTER_COLLISIONS`] places its spheres. A body whose new
//! state is not finite stops, and its first sphere is reported.
//!
//! [`AFTER_COLLISIONS`]: crate::model::layout::AFTER_COLLISIONS

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::impulse::BodyPush;
use crate::model::layout::{GRAIN, PUSHED_ROW, RIGID_PRESSED, RIGID_ROWS, RIGID_WORDS, RUBBED};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::rigid::Pose;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::body::Body;
use crate::physics::friction_impulses::pressed;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "push_bodies",
    wgsl: Wgsl::File(part!("step/bodies/push_bodies.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("bodies", Buffer::RigidBodies),
        write("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        read("next", Buffer::Y2),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    // Only collisions need work, and they are few.
    moves: |_| NONE,
    cpu: push_bodies,
};

fn push_bodies(world: &mut World, pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 2 {
        return;
    }
    if pass == RUBBED {
        world.pushes = friction_pushes(world);
    } else if world.step.traits().friction_impulses {
        count_pressed(world);
    }
    for push in std::mem::take(&mut world.pushes) {
        apply(world, &push);
    }
}

/// Counts the pressed contacts that touch each body.
fn count_pressed(world: &mut World) {
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let lists = Lists::new(&world.step, &world.lists);
    let on_body = |body: u32| {
        let mut count = 0;
        Body::Rigid(body).each_row(&view, |row| count += pressed(&lists, row).count() as u32);
        count
    };
    let bodies = (0..world.step.layout.rigid_bodies).into_par_iter().with_min_len(GRAIN);
    let counts: Vec<u32> = bodies.map(on_body).collect();
    let records = world.topology[world.step.layout.rigid_at as usize..].chunks_exact_mut(RIGID_WORDS as usize);
    records.zip(counts).for_each(|(record, count)| record[RIGID_PRESSED as usize] = count);
}

/// The pushes by the friction impulses on the spheres of each body, in the order of its members.
fn friction_pushes(world: &World) -> Vec<BodyPush> {
    let view = View::new(&world.step, &world.topology, &world.states[1]);
    let of_body = |body: u32| {
        let record = view.rigid_body(body);
        let (mut impulse, mut torque) = (Vec3::ZERO, Vec3::ZERO);
        for (index, _) in view.members(record) {
            let sphere = view.slot_of(index);
            impulse += view.velocity(sphere);
            torque += view.angular_momentum(sphere);
        }
        let push = BodyPush { body, velocity: record.inverse_mass * impulse, angular_momentum: torque, moved: None };
        (impulse != Vec3::ZERO || torque != Vec3::ZERO).then_some(push)
    };
    (0..world.step.layout.rigid_bodies).filter_map(of_body).collect()
}

fn apply(world: &mut World, push: &BodyPush) {
    let rows = &mut world.rigid_bodies[(push.body * RIGID_ROWS) as usize..][..RIGID_ROWS as usize];
    let before = Pose::of(rows);
    let moved = push.moved.map_or(before, |moved| Pose { orientation: moved.orientation, ..before.moved(moved.by) });
    let (velocity, momentum) = (before.velocity + push.velocity, before.momentum + push.angular_momentum);
    let mut after = Pose { velocity, momentum, ..moved };
    if !after.is_finite() {
        after = Pose { velocity: Vec3::ZERO, momentum: Vec3::ZERO, ..before };
        let view = View::new(&world.step, &world.topology, &world.states[0]);
        let mut tally = Tally::default();
        view.members(view.rigid_body(push.body)).take(1).for_each(|(index, _)| tally.count_bad(BadStage::Collisions, index));
        tally.add_to(&mut world.status);
    }
    rows[..Pose::ROWS].copy_from_slice(&after.rows());
    rows[PUSHED_ROW as usize] = Vec4::W;
}
