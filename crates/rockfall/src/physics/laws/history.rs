//! Where the springs of contacts are kept from step to step (docs/physics.md section 4.11).
//!
//! Every mover has a row of records, by insertion index, so rows do not change when memory is sorted. The record of a contact is
//! in the row of one of the two objects, its owner. The record names the other object by a key that does not depend on the order
//! of memory either. So records do not depend on pair lists at all. Each row is filled from its start; the first record without
//! a key ends it.
//!
//! There are two tables of rows: the springs before the step, and those after it. `end_step` exchanges them, so a rejected step
//! is repeated from the same springs. `history_table` of the status is the number, 0 or 1, of the table with the springs before
//! the step.

use glam::Vec3;

use crate::model::layout::{HISTORY_WORDS, NO_KEY};
use crate::model::step::Step;
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::laws::contact::Spring;

const WORDS: usize = HISTORY_WORDS as usize;

/// A table of springs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Histories<'a> {
    /// Words of a row.
    stride: usize,
    words: &'a [u32],
}

impl<'a> Histories<'a> {
    /// The springs before the step.
    pub(crate) fn of(world: &'a World) -> Self {
        Self::new(&world.step, &world.histories[first_word(world)..])
    }

    /// `words` begin with those of the table.
    pub(crate) fn new(step: &Step, words: &'a [u32]) -> Self {
        Self { stride: row_words(step), words }
    }

    /// The spring of the contact of two objects, by their ids in memory.
    pub(crate) fn spring(&self, view: &View, a: u32, b: u32, feature: u32) -> Option<Spring> {
        let owner = owner(view, a, b);
        let key = key(view, if owner == a { b } else { a }, feature);
        let row = self.row(view.insertion_index(owner));
        row.into_iter().find(|record| record.0 == key).map(|record| record.1)
    }

    /// Keys and springs of a row.
    pub(crate) fn row(&self, row: u32) -> Vec<(u32, Spring)> {
        let words = &self.words[row as usize * self.stride..][..self.stride];
        let records = words.chunks_exact(WORDS).take_while(|words| words[WORDS - 1] != NO_KEY);
        records.map(|words| (words[WORDS - 1], unpack(words))).collect()
    }
}

/// Words of a row: `history_room` records.
pub(crate) fn row_words(step: &Step) -> usize {
    step.history_room as usize * WORDS
}

/// Words of a table: one row per mover.
pub(crate) fn table_words(step: &Step) -> usize {
    step.movers() as usize * row_words(step)
}

/// First word of the springs before the step, in a world.
pub(crate) fn first_word(world: &World) -> usize {
    world.status.history_table as usize * table_words(&world.step)
}

/// The owner of a contact: the mover whose row keeps its spring. It is the smaller of two spheres or of two rods, because a
/// sphere has few contacts with spheres that are not smaller. Of two equal ones it is the first if both insertion indices are
/// even or both are odd, and otherwise the second. A mover thus owns about half of its contacts with equal ones, which keeps
/// rows short. A sphere owns its contacts with rods.
pub(crate) fn owner(view: &View, a: u32, b: u32) -> u32 {
    let (a, b) = view.ordered(a, b);
    let radii = match (view.object(a), view.object(b)) {
        (Object::Sphere(one), Object::Sphere(other)) => [view.radius(one), view.radius(other)],
        (Object::Rod(one), Object::Rod(other)) => [view.rod(one).radius, view.rod(other).radius],
        _ => return a,
    };
    let is_second =
        if radii[0] == radii[1] { (view.insertion_index(a) ^ view.insertion_index(b)) & 1 == 1 } else { radii[1] < radii[0] };
    if is_second { b } else { a }
}

/// The key of the other object of a contact in its owner's row.
pub(crate) fn key(view: &View, other: u32, feature: u32) -> u32 {
    view.insertion_index(other) << feature_bits(view.step) | feature
}

/// Bits of the feature in a key.
pub(crate) fn feature_bits(step: &Step) -> u32 {
    crate::model::layout::ENTRY_BITS - step.entry_id_bits()
}

/// Writes a record.
pub(crate) fn pack(words: &mut [u32], key: u32, spring: &Spring) {
    let Vec3 { x, y, z } = spring.shift;
    words[..4].copy_from_slice(&[x, y, z, spring.overlap].map(f32::to_bits));
    let Vec3 { x, y, z } = spring.moment;
    words[4..7].copy_from_slice(&[x, y, z].map(f32::to_bits));
    words[WORDS - 1] = key;
}

fn unpack(words: &[u32]) -> Spring {
    let number = |place: usize| f32::from_bits(words[place]);
    let [shift, moment] = [0, 4].map(|place| Vec3::new(number(place), number(place + 1), number(place + 2)));
    Spring { shift, overlap: number(3), moment }
}
