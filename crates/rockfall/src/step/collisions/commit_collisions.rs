//! Copies `Y2` to the state of the spheres whose bodies collided. Sets `collided` and `forces_due`. Does nothing in a rejected
//! step, or when an earlier attempt at the step has done its collisions.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::lists::Lists;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::collision::body::TakingPart;
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
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    // Few bodies collide. The counts show which ones do not.
    moves: |_| Moves { counts: 1, ..NONE },
    cpu: commit_collisions,
};

fn commit_collisions(world: &mut World, _pass: u32) {
    let World { step, topology, lists, states: [start, y2, ..], status, .. } = world;
    if status.rejected != 0 || status.collided == 1 {
        return;
    }
    status.collided = 2;
    status.forces_due = 1;
    if status.collides == 0 {
        return;
    }
    let lists = Lists::new(step, lists);
    let view = View::new(step, topology, start);
    let taking_part = TakingPart::new(&view, &lists);
    let n = step.spheres as usize;
    let spheres = (0..n).into_par_iter().with_min_len(GRAIN);
    let changed: Vec<usize> = spheres.filter(|sphere| taking_part.has(*sphere as u32)).collect();
    for place in changed.into_iter().flat_map(|sphere| [sphere, n + sphere, 2 * n + sphere]) {
        start[place] = y2[place];
    }
}
