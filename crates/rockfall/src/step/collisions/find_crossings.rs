//! Finds crossings: contacts that began within the last step and do not collide at its end (docs/physics section 3.10).
//!
//! For every sphere, regions 0 and 2 of `Y3` receive the crossing that counts for it, with the changes of position and
//! velocity, or a mark that it has none. `find_collisions` and `commit_collisions` read them. Where no step has led to the
//! present state (`lengths_due`), there are no crossings.
//!
//! The step is rejected when a sphere, or the place where it was before the last step, is outside its AABB
//! (`REJECTED_ESCAPED`). If both are inside, so is the path between them, and the lists hold every crossing. Like the other
//! stages of the phase, this stage does nothing when the step is rejected or its collisions are done.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::status::ESCAPED_ON_PATHS;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::crossing::Crossing;
use crate::physics::travel::{escape_ratio, outside};
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_crossings",
    wgsl: Wgsl::File(part!("step/collisions/find_crossings.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        read("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        write("crossings", Buffer::Y3),
        write("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    // Reads position, velocity and entries, and writes two rows.
    moves: |_| Moves { rows: 4, sphere_aabbs: 1, counts: 1, entries: 1, ..NONE },
    cpu: find_crossings,
};

fn find_crossings(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 0 {
        return;
    }
    let World { step, topology, states: [start, _, y3, _], lists, aabbs, status, .. } = world;
    let view = View::new(step, topology, start).at_evaluation(status, 0).in_collisions();
    let lists = Lists::new(step, lists);
    let has_moved = status.lengths_due == 0;
    let n = step.layout.spheres as usize;
    let (positions, rest) = y3.split_at_mut(n);
    let rows = positions.par_iter_mut().zip(&mut rest[n..]).enumerate().with_min_len(GRAIN);
    let escape_ratio = rows
        .map(|(place, (position, velocity))| {
            let sphere = place as u32;
            let crossing = if has_moved { Crossing::of(&view, &lists, sphere) } else { None };
            [*position, *velocity] = Crossing::rows(crossing);
            let before = view.position(sphere) - step.constants.dt * view.own_velocity(sphere);
            let of_path = if has_moved && !view.is_fixed(sphere) { outside(&view, aabbs, sphere, before) } else { 0.0 };
            escape_ratio(&view, aabbs, sphere).max(of_path)
        })
        .reduce(|| 0.0, f32::max);
    let mut tally = Tally::default();
    tally.note_escape(ESCAPED_ON_PATHS, escape_ratio);
    tally.add_to(status);
}
