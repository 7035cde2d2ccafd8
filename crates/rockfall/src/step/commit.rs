//! Makes the state in `Y2` the current state.

use rayon::prelude::*;

use crate::model::layout::GRAIN;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::needs_rebuild;

/// Copies `Y2` to the current state, and requests a rebuild of the lists if a sphere may soon leave its AABB.
pub(crate) fn commit(world: &mut World) {
    let [start, y2, ..] = &mut world.states;
    // The velocities at the time of the positions are computed anew in the next phase of collisions.
    let regions = 4 * world.step.spheres as usize;
    start[..regions].copy_from_slice(&y2[..regions]);
    let view = View::new(&world.step, &world.topology, start);
    let spheres = (0..world.step.spheres).into_par_iter().with_min_len(GRAIN);
    if spheres.any(|sphere| needs_rebuild(&view, &world.aabbs, sphere, view.position(sphere), view.velocity(sphere))) {
        world.status.rebuild |= REBUILD_REQUESTED;
    }
}
