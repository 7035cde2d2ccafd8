//! Collisions, 4 of 4: friction impulses, once a step, of all contacts that press, in scenes that have them (docs/physics.md section 3.9).
//!
//! `collision_friction` limits them by the normal impulse of the collision phase, `coulomb_friction` by what the contact force gives within
//! the step. The new state of all spheres goes to `Y2`. Does nothing in a void step, nor when the collisions of the step were done before.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::Rows;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::friction_impulses::FrictionImpulses;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "apply_friction_impulses",
    wgsl: Wgsl::File(part!("step/collisions/apply_friction_impulses.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: apply_friction_impulses,
};

fn apply_friction_impulses(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 2 {
        return;
    }
    let [start, y2, ..] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start);
    let lists = Lists::new(&world.step, &world.lists);
    let rubbing = FrictionImpulses::new(&view, &lists, &world.impulses);
    let tally = Rows::of(y2, world.step.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                let before = view.position(sphere);
                let after = rubbing.rubbed(sphere).or_stopped(before, BadStage::Collisions, view.user(sphere), &mut tally);
                rows.set(&view, sphere, after);
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}
