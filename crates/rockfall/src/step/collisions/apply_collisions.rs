//! Applies the impulses of all collisions to the bodies (docs/physics sections 3.5 to 3.7). A lone collision is handled
//! at its time of contact. Collisions that share bodies, and those on networks of rods, are solved by sweeps.
//!
//! On the CPU, this stage also computes the impulses.
//!
//! The new state of the spheres of all bodies that collide goes to `Y2`, because other spheres still read the old state. A
//! sphere whose new state is not finite keeps its position, loses velocity and spin, and is reported. The step is rejected if the
//! impulses on a network of rods could not be solved.

use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::{Motion, Rows};
use crate::model::status::REJECTED_NETWORKS;
use crate::model::step::Aabb;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::all::{Outcome, solve};
use crate::physics::collision::body::TakingPart;
use crate::physics::travel::needs_rebuild;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "apply_collisions",
    wgsl: Wgsl::File(part!("step/collisions/apply_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        read("collision_indices", Buffer::CollisionIndices),
        read("collisions", Buffer::Collisions),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedSpheres,
    // Few bodies collide. The counts show which ones do not.
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: apply_collisions,
};

fn apply_collisions(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 0 {
        return;
    }
    world.impulses.clear();
    if world.status.collides == 0 {
        return;
    }
    let [start, y2, ..] = &mut world.states;
    let view = View::new(&world.step, &world.topology, start).at_evaluation(&world.status, 0).in_collisions();
    let lists = Lists::new(&world.step, &world.lists);
    let outcome = solve(&view, &lists);
    if outcome.is_unsolved {
        world.status.rejected |= REJECTED_NETWORKS;
        return;
    }
    let taking_part = TakingPart::new(&view, &lists);
    let tally = Rows::of(y2, world.step.layout.spheres)
        .map(|mut rows| {
            let mut tally = Tally::default();
            for sphere in rows.spheres().filter(|sphere| taking_part.has(*sphere)) {
                let after = collided(&view, &outcome, &world.aabbs, sphere, &mut tally);
                rows.set_after_collisions(&view, sphere, after);
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(&mut world.status);
    world.impulses = outcome.impulses;
}

/// Returns the state of a sphere after its collisions. Requests new lists if the sphere may then leave its AABB.
fn collided(view: &View, outcome: &Outcome, aabbs: &[Aabb], sphere: u32, tally: &mut Tally) -> Motion {
    let before = Motion::of(view, sphere);
    let change = outcome.change(sphere);
    let (position, low) = before.moved(change.position);
    let after = Motion {
        position,
        low,
        velocity: before.velocity + change.velocity,
        angular_momentum: before.angular_momentum + change.angular_momentum,
        ..before
    };
    let after = after.or_stopped(&before, BadStage::Collisions, view.insertion_index(sphere), tally);
    tally.rebuild |= needs_rebuild(view, aabbs, sphere, after.position, after.velocity);
    after
}
