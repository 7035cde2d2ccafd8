//! Collisions, 1 of 3: which pairs overlap, and which of them collide (physics.md section 3).
//!
//! Bodies that touch overlap by rounding; what is no deeper than 1e-5 of the smaller radius presses nothing. (Else the blow
//! on a touching cradle would count as one in a crowd, and gain energy from the overlap that is left to the forces.)
//! Sets `ENTRY_OVERLAPS` and `ENTRY_COLLIDES` in the entries of both sides, once, so that no later stage decides again, and
//! `LIST_COLLIDES` in the count of a mover with some colliding entry; counts every collision once (at the mover of lower id). Voids the step when a sphere is outside its AABB
//! (`VOID_ESCAPED`). Like the other two it does nothing when the step is void or its collisions are done.

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::collision::Collision;
use crate::cpu::lists::Lists;
use crate::cpu::tally::{Tally, escape_ratio};
use crate::cpu::view::View;
use crate::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS, LIST_COLLIDES, LIST_COUNT_MASK};
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_collisions",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/plain.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("stage/find_collisions.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        write("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Movers,
    cpu: find_collisions,
};

fn find_collisions(world: &mut World, _pass: u32) {
    if world.status.void != 0 || world.status.collided != 0 {
        return;
    }
    let view = View::new(&world.step, &world.words, &world.states[0]);
    let lists = Lists::new(&world.step, &world.lists);
    let found: Vec<Found> = (0..world.step.spheres + world.step.rods)
        .into_par_iter()
        .with_min_len(GRAIN)
        .map(|mover| find(&view, &lists, world, mover))
        .collect();
    for (count, Found { collides, tally, .. }) in world.lists.iter_mut().zip(&found) {
        *count = *count & LIST_COUNT_MASK | if *collides { LIST_COLLIDES } else { 0 };
        tally.tell(&mut world.status);
    }
    for (slot, word) in found.into_iter().flat_map(|found| found.changed) {
        world.lists[(world.step.entries_at + slot) as usize] = word;
    }
}

/// What was found of a mover.
struct Found {
    /// Slots and new words of the entries that are no longer what they were.
    changed: Vec<(u32, u32)>,
    /// Some entry collides.
    collides: bool,
    tally: Tally,
}

fn find(view: &View, lists: &Lists, world: &World, mover: u32) -> Found {
    let (mut tally, mut collides) = (Tally::default(), false);
    if mover < world.step.spheres {
        tally.escape_ratio = escape_ratio(view, &world.aabbs, mover);
    }
    let entries = lists.row(mover).filter_map(|entry| {
        let mut word = entry.word & !(ENTRY_OVERLAPS | ENTRY_COLLIDES);
        let collision = Collision::between(view, mover, entry.id(), entry.feature());
        if let Some(collision) = collision.filter(|collision| collision.is_pressed(view)) {
            word |= ENTRY_OVERLAPS;
            if collision.collides(view) {
                word |= ENTRY_COLLIDES;
                tally.collisions += u32::from(view.user(mover) < view.user(entry.id()));
            }
        }
        collides |= word & ENTRY_COLLIDES != 0;
        (word != entry.word).then_some((entry.slot, word))
    });
    let changed = entries.collect();
    Found { changed, collides, tally }
}
