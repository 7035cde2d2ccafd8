//! Applies the impulses of collisions to rigid bodies (docs/physics.md section 3.11). They change the velocity and the angular momentum of a
//! body. A lone collision also displaces and turns it, as it has moved since its time of contact.
//!
//! The stage follows `commit_collisions`. The thread of the first sphere of a body reads the records of its collisions, and of the state only
//! the positions of its own spheres. It marks the body in [`PUSHED_ROW`], so that [`AFTER_COLLISIONS`] places its spheres. A body whose new
//! state is not finite stops, and its first sphere is reported.
//!
//! [`AFTER_COLLISIONS`]: crate::model::layout::AFTER_COLLISIONS

use glam::{Vec3, Vec4};

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::impulse::BodyPush;
use crate::model::layout::{PUSHED_ROW, RIGID_ROWS};
use crate::model::part::part;
use crate::model::rigid::Pose;
use crate::model::view::View;
use crate::model::world::World;
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
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
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
