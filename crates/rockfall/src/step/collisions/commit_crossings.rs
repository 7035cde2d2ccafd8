//! Applies the crossings that are handled (docs/physics.md section 3.10). Their spheres take part in no other collision of the step,
//! so the changes that `find_crossings` computed still hold. Requests new lists if a sphere may then leave its AABB.
//!
//! Does nothing in a rejected step, or when an earlier attempt at the step has done its collisions.

use glam::Vec3;
use rayon::prelude::*;

use crate::error::BadStage;
use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::state::Motion;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::crossing::{Crossing, Crossings};
use crate::physics::travel::needs_rebuild;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_crossings",
    wgsl: Wgsl::File(part!("step/collisions/commit_crossings.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("crossings", Buffer::Y3),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Reads the row that tells whether there is a crossing. Few spheres have one.
    moves: |_| Moves { rows: 1, ..NONE },
    cpu: commit_crossings,
};

fn commit_crossings(world: &mut World, _pass: u32) {
    let World { step, topology, states: [start, _, y3, _], aabbs, status, .. } = world;
    // `commit_collisions` sets it to 2 in the attempt that does the collisions.
    if status.rejected != 0 || status.collided != 2 {
        return;
    }
    let view = View::new(step, topology, start).in_collisions();
    let crossings = Crossings::new(step, y3);
    let spheres = (0..step.spheres).into_par_iter().with_min_len(GRAIN);
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
    let n = step.spheres as usize;
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
