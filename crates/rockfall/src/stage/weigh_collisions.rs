//! Collisions, 2 of 4: the weight s_k of every colliding contact (physics.md section 3).
//!
//! The weight goes to the entry of both sides; it is negative where the overlap is to be removed too, that is where
//! the row sum over all overlapping contacts is 1 within 0.001.

use rayon::prelude::*;

use crate::cpu::collision::{Collision, row_sums};
use crate::cpu::lists::Lists;
use crate::cpu::view::View;
use crate::layout::ENTRY_COLLIDES;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "weigh_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/plain.wgsl"),
        part!("stage/weigh_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        read("lists", Buffer::Lists),
        write("weights", Buffer::Weights),
        read("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: weigh_collisions,
};

/// Row sums up to this count as 1: nothing else presses.
const ALONE: f32 = 1.001;

fn weigh_collisions(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.collided != 0 || world.status.collisions == 0 {
        return;
    }
    let view = View::new(&world.step, &world.words, &world.states[0]);
    let lists = Lists::new(&world.step, &world.lists);
    let weights: Vec<(u32, f32)> = (0..world.step.spheres + world.step.rods)
        .into_par_iter()
        .filter(|mover| lists.collides(*mover))
        .flat_map_iter(|mover| {
            let colliding = lists.row(mover).filter(|entry| entry.word & ENTRY_COLLIDES != 0);
            colliding.filter_map(move |entry| {
                let collision = Collision::between(&view, mover, entry.id(), entry.feature())?;
                let sums = row_sums(&view, &lists, &collision);
                let sign = if sums.overlapping <= ALONE { -1.0 } else { 1.0 };
                Some((entry.slot, sign / sums.colliding))
            })
        })
        .collect();
    for (slot, weight) in weights {
        world.weights[slot as usize] = weight;
    }
}
