//! Applies friction impulses to all pressed contacts, once per step, in scenes that have them (docs/physics section
//! 3.9).
//!
//! The limit of a friction impulse is `collision_friction` times the normal impulse of the contact in this step, plus
//! `coulomb_friction` times the contact force times the time step. The new state of all spheres goes to `Y2`. The stage does
//! nothing in a rejected step, or when an earlier attempt at the step has done its collisions.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::friction_impulses::FrictionImpulses;
use crate::step::moves::{Moves, NONE};
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
    // Reads and writes 3 rows; reads the entries for pressed contacts.
    moves: |_| Moves { rows: 6, counts: 1, entries: 1, ..NONE },
    cpu: apply_friction_impulses,
};

fn apply_friction_impulses(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 2 {
        return;
    }
    let [start, y2, ..] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start);
    let lists = Lists::new(&world.step, &world.lists);
    let friction = FrictionImpulses::new(&view, &lists, &world.impulses);
    let tally = Rows::of(y2, world.step.layout.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            for sphere in rows.spheres() {
                let before = Motion::of(&view, sphere);
                let after = friction.rubbed(sphere);
                let after = after.or_stopped(&before, BadStage::Collisions, view.insertion_index(sphere), &mut tally);
                rows.set(&view, sphere, after);
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
}
