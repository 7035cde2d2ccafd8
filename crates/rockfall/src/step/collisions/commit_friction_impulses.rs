//! Copies `Y2` to the state of all spheres after the friction impulses, in scenes that have them. Does nothing in a rejected
//! step, or when an earlier attempt at the step has done its collisions. Requests new lists (`rebuild`) if a sphere may leave
//! its AABB within the next step.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::needs_rebuild;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_friction_impulses",
    wgsl: Wgsl::File(part!("step/collisions/commit_friction_impulses.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("next", Buffer::Y2),
        read("topology", Buffer::Topology),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::WideSpheres,
    moves: |_| Moves { rows: 6, sphere_aabbs: 1, ..NONE },
    cpu: commit_friction_impulses,
};

fn commit_friction_impulses(world: &mut World, _pass: u32) {
    if world.status.rejected == 0 && world.status.collided == 2 {
        commit(world);
    }
}

/// Copies `Y2` to the current state, and requests a rebuild of the lists if a sphere may soon leave its AABB.
fn commit(world: &mut World) {
    let [start, y2, ..] = &mut world.states;
    let n = world.step.layout.spheres as usize;
    let next = View::new(&world.step, &world.topology, y2);
    // The velocities at the time of the positions are computed anew in the next phase of collisions.
    for row in 0..4 {
        let of_spheres = row * n..(row + 1) * n;
        let rows = start[of_spheres.clone()].par_iter_mut().zip(&y2[of_spheres]).enumerate().with_min_len(GRAIN);
        rows.filter(|(sphere, _)| next.body_of_sphere(*sphere as u32).is_none()).for_each(|(_, (to, from))| *to = *from);
    }
    let view = View::new(&world.step, &world.topology, start);
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let spheres = spheres.filter(|sphere| view.body_of_sphere(*sphere).is_none());
    if spheres.any(|sphere| needs_rebuild(&view, &world.aabbs, sphere, view.position(sphere), view.velocity(sphere))) {
        world.status.rebuild |= REBUILD_REQUESTED;
    }
}
