//! Collisions, after 2 of 3: what `apply_collisions` does, for spheres with long lists. A workgroup weighs the collisions of each, a
//! thread one of them; their shares are added up in the order of the list.

use rayon::prelude::*;

use crate::cpu::collision::takes_part;
use crate::cpu::grid::long_movers;
use crate::cpu::lists::Lists;
use crate::cpu::state::Rows;
use crate::cpu::tally::Tally;
use crate::cpu::view::View;
use crate::stage::apply_collisions::{collided, is_shared_out};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "apply_long",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/lists.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/plain.wgsl"),
        part!("wgsl/weights.wgsl"),
        part!("wgsl/stored_sums.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("wgsl/changes.wgsl"),
        part!("wgsl/long.wgsl"),
        part!("stage/apply_long.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        write("next", Buffer::Y2),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        read("cells", Buffer::Cells),
        read("row_sums", Buffer::RowSums),
        write("status", Buffer::Status),
    ],
    threads: Threads::LongMovers,
    cpu: apply_long,
};

fn apply_long(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.collided != 0 || world.status.collides == 0 {
        return;
    }
    let [start, y2, ..] = &mut world.states;
    let view = View::new(&world.step, &world.words, start);
    let lists = Lists::new(&world.step, &world.lists);
    let spheres = long_movers(&world.step, &world.cells).par_iter().filter(|mover| **mover < world.step.spheres);
    let applied_here = |sphere: &&u32| takes_part(&view, &lists, **sphere) && is_shared_out(&view, &lists, **sphere);
    let changed: Vec<_> = spheres
        .filter(applied_here)
        .map(|sphere| {
            let mut tally = Tally::default();
            (*sphere, collided(&view, &lists, &world.row_sums, &world.aabbs, *sphere, &mut tally), tally)
        })
        .collect();
    for (sphere, after, tally) in changed {
        Rows::of_one(y2, world.step.spheres, sphere).set(&view, sphere, after);
        tally.tell(&mut world.status);
    }
}
