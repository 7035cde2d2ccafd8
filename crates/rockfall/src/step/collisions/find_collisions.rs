//! Decides which contacts are pressed and which of them collide (docs/physics section 3.1).
//!
//! An overlap of at most 1e-5 of the smaller radius is a rounding error of objects that just touch, so it does not make a
//! contact pressed. Otherwise the first impact on a Newton's cradle whose balls touch would count as a collision in a
//! cluster. Where collisions are switched off, no contact collides, but pressed contacts still get friction impulses.
//!
//! The stage sets `ENTRY_OVERLAPS` for pressed contacts and `ENTRY_COLLIDES` for colliding ones, in the list entries of
//! both sides. Later stages read these bits and do not decide again. `LIST_COLLIDES` is set in the count of a mover that
//! has a colliding entry. Each collision is counted once, at the mover with the lower insertion index.
//!
//! On the GPU the stage also creates a record for every collision, and stores the number of the record with the list entries of both
//! sides (docs/physics sections 3.5 to 3.7). The CPU needs no records: `apply_collisions` solves all collisions there.
//!
//! The contacts of a sphere whose crossing is handled do not collide (docs/physics section 3.10).
//!
//! The step is rejected when a sphere is outside its AABB (`REJECTED_ESCAPED`). Like the other stages of the phase, this
//! stage does nothing when the step is rejected or its collisions are done.

use std::cell::Cell;

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::layout::{
    ENTRY_COLLIDES, ENTRY_OVERLAPS, FLAG_COLLISIONS, FLAG_CONTINUOUS, LIST_COLLIDES, LIST_COUNT_MASK, SLICE,
};
use crate::model::lists::{Entry, Slice, slices};
use crate::model::part::part;
use crate::model::status::ESCAPED_IN_COLLISIONS;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::balls::Ball;
use crate::physics::collision::Collision;
use crate::physics::collision::crossing::Crossings;
use crate::physics::surface::Hidden;
use crate::physics::travel::escape_ratio;
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "find_collisions",
    wgsl: Wgsl::File(part!("step/collisions/find_collisions.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        write("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
        read("crossings", Buffer::Y3),
        write("collision_indices", Buffer::CollisionIndices),
        write("collisions", Buffer::Collisions),
    ],
    threads: Threads::SharedMovers,
    // Reads position, velocity and entries. Few entries change.
    moves: |_| Moves { rows: 2, sphere_aabbs: 1, counts: 1, entries: 1, ..NONE },
    cpu: find_collisions,
};

fn find_collisions(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 || world.status.collided != 0 {
        return;
    }
    let World { step, topology, states: [state, _, y3, _], lists, aabbs, status, .. } = world;
    let view = View::new(step, topology, state).in_collisions();
    let crossings = (step.constants.flags & FLAG_CONTINUOUS != 0).then_some(Crossings::new(step, y3));
    let tally = slices(step, lists)
        .into_par_iter()
        .with_min_len(GRAIN / SLICE as usize)
        .map(|mut slice| {
            let mut tally = Tally::default();
            for place in 0..slice.counts.len() {
                let mover = slice.first + place as u32;
                if mover < step.layout.spheres {
                    tally.note_escape(ESCAPED_IN_COLLISIONS, escape_ratio(&view, aabbs, mover));
                }
                mark(&view, crossings, &mut slice, place, &mut tally);
            }
            tally
        })
        .reduce(Tally::default, Tally::merge);
    tally.add_to(status);
}

/// Marks the entries of the mover at this place of a slice, and the mover's count if one of them collides.
fn mark(view: &View, crossings: Option<Crossings>, slice: &mut Slice, place: usize, tally: &mut Tally) {
    let mover = slice.first + place as u32;
    let count = slice.counts[place] & LIST_COUNT_MASK;
    let words = Cell::from_mut(&mut *slice.words).as_slice_of_cells();
    let word = |entry: u32| &words[(entry * SLICE) as usize + place];
    let id_mask = view.step.entry_id_mask();
    let list = |place: u32| Entry::new(id_mask, place, word(place).get() & !(ENTRY_OVERLAPS | ENTRY_COLLIDES));
    (0..count).for_each(|place| word(place).set(list(place).word));
    slice.counts[place] &= !LIST_COLLIDES;
    let is_put_off = |entry: &Entry| {
        crossings.is_some_and(|crossings| [mover, entry.id()].into_iter().any(|id| crossings.handled(id).is_some()))
    };
    let mut set = |entry: &Entry, bits: u32| {
        let bits = if bits & ENTRY_COLLIDES != 0 && is_put_off(entry) { ENTRY_OVERLAPS } else { bits };
        word(entry.place).set(entry.word | bits);
        if bits & ENTRY_COLLIDES != 0 {
            slice.counts[place] |= LIST_COLLIDES;
            tally.collisions += u32::from(view.insertion_index(mover) < view.insertion_index(entry.id()));
        }
    };
    let done = Ball::new(view, mover)
        .map_or(0, |ball| ball.for_each_near(count, list, |others| classify_group(&ball, mover, others, &mut set)));
    let hidden = Hidden::of(view, mover, count, list);
    for entry in (done..count).map(list) {
        set(&entry, if hidden.has(&entry) { 0 } else { classify(view, mover, entry) });
    }
}

/// Returns the bits of a pair.
fn classify(view: &View, mover: u32, entry: Entry) -> u32 {
    let collision = Collision::between(view, mover, entry.id(), entry.feature());
    collision.map_or(0, |collision| entry_bits(view, collision.is_pressed(view), collision.collides(view)))
}

/// Sets the bits of a sphere without rods and up to four other objects.
#[inline]
fn classify_group(ball: &Ball, mover: u32, others: &[Entry], set: &mut impl FnMut(&Entry, u32)) {
    let meeting = ball.meet(others);
    let pressed = meeting.are_pressed().bitmask();
    let collide = meeting.collide(ball.view).bitmask();
    for (lane, other) in others.iter().enumerate() {
        let bits = if ball.view.is_ball(other.id()) {
            entry_bits(ball.view, pressed >> lane & 1 == 1, collide >> lane & 1 == 1)
        } else {
            classify(ball.view, mover, *other)
        };
        set(other, bits);
    }
}

/// The bits of a contact that is pressed or not, and whose approach velocity exceeds the threshold or not.
fn entry_bits(view: &View, is_pressed: bool, collides: bool) -> u32 {
    match (is_pressed, collides && view.step.constants.flags & FLAG_COLLISIONS != 0) {
        (false, _) => 0,
        (true, false) => ENTRY_OVERLAPS,
        (true, true) => ENTRY_OVERLAPS | ENTRY_COLLIDES,
    }
}
