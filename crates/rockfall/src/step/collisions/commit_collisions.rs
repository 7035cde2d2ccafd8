//! Copies `Y2` to the state of the spheres whose bodies collided. Sets `collided` and `forces_due`. Does nothing in a rejected
//! step, or when an earlier attempt at the step has done its collisions.
//!
//! With `continuous_collisions` it also applies the crossings that are handled (docs/physics section 3.10). Their spheres take part
//! in no other collision of the step, so the changes that `find_crossings` computed still hold. Requests new lists if a sphere may
//! then leave its AABB.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{FLAG_CONTINUOUS, GRAIN};
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::state::Motion;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::body::TakingPart;
use crate::physics::collision::crossing::{Crossing, Crossings};
use crate::physics::travel::needs_rebuild;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_collisions",
    wgsl: Wgsl::File(part!("step/collisions/commit_collisions.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("crossings", Buffer::Y3),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Few bodies collide. The counts show which ones do not.
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: commit_collisions,
};

fn commit_collisions(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided == 1 {
        return;
    }
    world.status.collided = 2;
    world.status.forces_due = 1;
    if world.status.collides != 0 {
        commit_changes(world);
    }
    if world.step.constants.flags & FLAG_CONTINUOUS != 0 {
        commit_crossings(world);
    }
}

fn commit_changes(world: &mut World) {
    let World { step, topology, lists, states: [start, y2, ..], .. } = world;
    let lists = Lists::new(step, lists);
    let view = View::new(step, topology, start).in_collisions();
    let taking_part = TakingPart::new(&view, &lists);
    let n = step.layout.spheres as usize;
    let spheres = (0..n).into_par_iter().with_min_len(GRAIN);
    let changed: Vec<usize> = spheres.filter(|sphere| taking_part.has(*sphere as u32)).collect();
    let regions = step.collision_regions() as usize;
    for place in changed.into_iter().flat_map(|sphere| (0..regions).map(move |region| region * n + sphere)) {
        start[place] = y2[place];
    }
}

fn commit_crossings(world: &mut World) {
    let World { step, topology, states: [start, _, y3, _], aabbs, status, .. } = world;
    let view = View::new(step, topology, start).in_collisions();
    let crossings = Crossings::new(step, y3);
    let spheres = (0..step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let handled: Vec<(u32, Crossing)> = spheres.filter_map(|sphere| Some((sphere, crossings.handled(sphere)?))).collect();
    let mut tally = Tally::default();
    let after: Vec<(u32, Motion, Vec3)> = handled
        .into_iter()
        .map(|(sphere, crossing)| {
            let before = Motion::of(&view, sphere);
            let (position, low) = before.moved(crossing.change.position);
            let after = Motion { position, low, velocity: before.velocity + crossing.change.velocity, ..before };
            let after = after.or_stopped(&before, BadStage::Collisions, view.insertion_index(sphere), &mut tally);
            tally.rebuild |= needs_rebuild(&view, aabbs, sphere, after.position, after.velocity);
            // A pair of moving spheres is counted once, at the sphere that was added first.
            let is_second = !crossing.is_alone && view.ordered(sphere, crossing.other).1 == sphere;
            tally.collisions += u32::from(!is_second);
            (sphere, after, view.own_velocity_after(sphere, after.velocity))
        })
        .collect();
    let n = step.layout.spheres as usize;
    for (sphere, after, own_velocity) in after {
        let place = sphere as usize;
        start[place] = after.position.extend(start[place].w);
        start[n + place] = own_velocity.extend(start[n + place].w);
        if step.is_half_step() {
            start[4 * n + place] = after.velocity.extend(start[n + place].w);
        }
        start[2 * n + place] = after.angular_momentum.extend(start[2 * n + place].w);
        start[3 * n + place] = after.low.extend(0.0);
    }
    // The later stages of the phase need no collision in a list for these.
    let collides = status.collides;
    tally.add_to(status);
    status.collides = collides;
}
