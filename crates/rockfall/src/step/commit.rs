//! The state in `Y2` becomes the state.

use rayon::prelude::*;

use crate::model::layout::GRAIN;
use crate::model::status::LISTS_ASKED;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::asks_for_lists;

/// `Y2` becomes the state, and spheres ask for lists.
pub(crate) fn commit(world: &mut World) {
    let [start, y2, ..] = &mut world.states;
    start.copy_from_slice(y2);
    let view = View::new(&world.step, &world.words, start);
    let spheres = (0..world.step.spheres).into_par_iter().with_min_len(GRAIN);
    if spheres.any(|sphere| asks_for_lists(&view, &world.aabbs, sphere, view.position(sphere), view.velocity(sphere))) {
        world.status.rebuild |= LISTS_ASKED;
    }
}
