//! Collisions, in scenes with rods or large spheres, after 1 of 3: how much every collision weighs, worked out once and stored with the
//! entries of both sides, for up to four spheres share in one, each of which may have dozens of contacts coupled with it, a large one
//! hundreds (physics.md section 3).
//!
//! Stored is the row sum 1 / s_k over the colliding contacts, negative where the one over all that overlap is 1 within 0.001: there
//! nothing else presses, and the overlap is removed too. Entries that do not collide keep what was there.
//!
//! What takes a device long is not that there is much to do but that one load waits for another, so a workgroup works out the coupled
//! contacts of all collisions of its movers side by side, and adds them up in the order of the lists.

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::collision::{Collision, Incident, row_sums};
use crate::cpu::lists::Lists;
use crate::cpu::view::View;
use crate::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
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
        part!("wgsl/coupled.wgsl"),
        part!("wgsl/teams.wgsl"),
        part!("wgsl/weigh_plain.wgsl"),
        part!("wgsl/weigh_large.wgsl"),
        part!("stage/weigh_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("row_sums", Buffer::RowSums),
        write("status", Buffer::Status),
    ],
    threads: Threads::SharedMovers,
    cpu: weigh_collisions,
};

fn weigh_collisions(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.collided != 0 || world.status.collides == 0 {
        return;
    }
    let view = View::new(&world.step, &world.words, &world.states[0]);
    let lists = Lists::new(&world.step, &world.lists);
    let movers = (0..world.movers()).into_par_iter().with_min_len(GRAIN);
    let weighed: Vec<_> =
        movers.filter(|mover| lists.collides(*mover)).flat_map_iter(|mover| weigh(&view, &lists, mover)).collect();
    for (slot, sum) in weighed {
        world.row_sums[slot] = sum;
    }
}

/// The row sums of the collisions in a mover's list, and where they belong.
fn weigh(view: &View, lists: &Lists, mover: u32) -> Vec<(usize, f32)> {
    // Of a sphere they have many of the coupled contacts in common.
    let known = (mover < view.step.spheres).then(|| Incident::of(view, lists, mover, ENTRY_OVERLAPS));
    let colliding = lists.row(mover).filter(|entry| entry.word & ENTRY_COLLIDES != 0);
    let weighed = colliding.filter_map(|entry| {
        let collision = Collision::between(view, mover, entry.id(), entry.feature())?;
        let sums = row_sums(view, lists, &collision, known.as_ref());
        Some((lists.slot(mover, entry), sums.told()))
    });
    weighed.collect()
}
