//! Where the springs of contacts are kept from step to step (docs/physics section 4.11).
//!
//! The record of a contact belongs to one of the two objects, its owner. The record names the other object by a key that does not
//! depend on the order of memory. So records do not depend on pair lists at all.
//!
//! Every mover has a block of [`HISTORY_BLOCK`] records, by insertion index, so blocks do not change when memory is sorted. A
//! mover that owns more contacts has a chain of blocks. The further ones come from a pool, which follows the blocks of the
//! movers. The last record of a block that does not end the chain is a link: its key is the number of the next block, with the
//! bit [`LINK_KEY`]. Each block is filled from its start. A chain ends at the first record without a key, or after the last
//! record of a block if that is no link. Which block of the pool a mover takes has no effect on results.
//!
//! There are two tables of blocks: the springs before the step, and those after it. `end_step` exchanges them, so a rejected step
//! is repeated from the same springs. `history_table` of the status is the number, 0 or 1, of the table with the springs before
//! the step.

use glam::Vec3;

use crate::model::layout::{HISTORY_BLOCK, HISTORY_WORDS, LINK_KEY, MAX_HISTORY_BLOCKS, NO_KEY};
use crate::model::step::Step;
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::laws::contact::Spring;

const WORDS: usize = HISTORY_WORDS as usize;
const BLOCK: usize = HISTORY_BLOCK as usize;
/// Words of a block.
pub(crate) const BLOCK_WORDS: usize = BLOCK * WORDS;
/// Least number of blocks by which the pool grows.
const LEAST_GROWTH: u32 = 16;

/// A spring as it is stored.
pub(crate) type Record = [u32; WORDS];

/// A table of springs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Histories<'a> {
    words: &'a [u32],
}

impl<'a> Histories<'a> {
    /// The springs before the step.
    pub(crate) fn of(world: &'a World) -> Self {
        Self::new(&world.histories[first_word(world)..])
    }

    /// `words` begin with those of the table.
    pub(crate) fn new(words: &'a [u32]) -> Self {
        Self { words }
    }

    /// The spring of the contact of two objects, by their ids in memory.
    pub(crate) fn spring(&self, view: &View, a: u32, b: u32, feature: u32) -> Option<Spring> {
        let owner = owner(view, a, b);
        let key = key(view, if owner == a { b } else { a }, feature);
        self.records(view.insertion_index(owner)).find(|record| record[WORDS - 1] == key).map(unpack)
    }

    /// Keys and springs of a mover, by its insertion index.
    pub(crate) fn springs(&self, mover: u32) -> impl Iterator<Item = (u32, Spring)> + use<'a> {
        self.records(mover).map(|record| (record[WORDS - 1], unpack(record)))
    }

    /// The records of a mover, by its insertion index.
    fn records(&self, mover: u32) -> Records<'a> {
        Records { words: self.words, next: Some(mover as usize * BLOCK) }
    }
}

/// Follows a chain of blocks.
struct Records<'a> {
    words: &'a [u32],
    /// Number of the next record in the table; `None` after the last one.
    next: Option<usize>,
}

impl<'a> Iterator for Records<'a> {
    type Item = &'a [u32];

    fn next(&mut self) -> Option<&'a [u32]> {
        loop {
            let place = self.next?;
            let record = &self.words[place * WORDS..][..WORDS];
            match record[WORDS - 1] {
                NO_KEY => self.next = None,
                key if key & LINK_KEY != 0 => self.next = Some((key & !LINK_KEY) as usize * BLOCK),
                _ => {
                    self.next = Some(place + 1).filter(|next| next % BLOCK != 0);
                    return Some(record);
                }
            }
        }
    }
}

/// Writes chains of blocks.
pub(crate) struct Chains<'a> {
    /// The words of a table.
    words: &'a mut [u32],
    movers: u32,
    /// Blocks of the pool that are taken, including those that it has no room for.
    taken: u32,
}

impl<'a> Chains<'a> {
    /// `taken` blocks of the pool are not free. `words` are those of the table.
    pub(crate) fn new(words: &'a mut [u32], movers: u32, taken: u32) -> Self {
        Self { words, movers, taken }
    }

    /// Writes the records of a mover, by its insertion index. Blocks for which the pool has no room are only counted.
    pub(crate) fn put(&mut self, mover: u32, mut records: &[Record]) {
        let mut block = mover;
        while records.len() > BLOCK {
            let (own, rest) = records.split_at(BLOCK - 1);
            let next = self.movers + self.taken;
            self.taken += 1;
            let link = std::array::from_fn(|word| if word == WORDS - 1 { LINK_KEY | next } else { 0 });
            self.fill(block, own.iter().chain([&link]));
            (block, records) = (next, rest);
        }
        self.fill(block, records.iter().chain([&[NO_KEY; WORDS]]));
    }

    /// Blocks of the pool that the chains need.
    pub(crate) fn blocks(&self) -> u32 {
        self.taken
    }

    fn fill<'r>(&mut self, block: u32, records: impl Iterator<Item = &'r Record>) {
        let first = block as usize * BLOCK_WORDS;
        let Some(words) = self.words.get_mut(first..first + BLOCK_WORDS) else { return };
        words.chunks_exact_mut(WORDS).zip(records).for_each(|(place, record)| place.copy_from_slice(record));
    }
}

/// The springs that a mover owns after the step.
#[derive(Default)]
pub(crate) struct Owned<'a> {
    /// The block of the mover; empty in an evaluation that does not advance springs.
    block: &'a mut [u32],
    /// Number of springs.
    count: usize,
    /// All records of a mover that needs further blocks, and none of others.
    all: Vec<Record>,
}

impl<'a> Owned<'a> {
    /// No springs. `block` is that of the mover, or empty in an evaluation that does not advance springs.
    pub(crate) fn new(block: &'a mut [u32]) -> Self {
        block.fill(NO_KEY);
        Self { block, ..Self::default() }
    }

    /// Adds a spring.
    pub(crate) fn push(&mut self, record: Record) {
        if self.block.is_empty() {
            return;
        }
        let (records, _) = self.block.as_chunks_mut();
        if let Some(place) = records.get_mut(self.count) {
            *place = record;
        } else {
            if self.all.is_empty() {
                self.all.extend_from_slice(records);
            }
            self.all.push(record);
        }
        self.count += 1;
    }

    /// The records that the block has no room for, with those in it; empty if it has.
    pub(crate) fn into_long(self) -> Vec<Record> {
        self.all
    }
}

/// Blocks of the pool that a mover with this number of records needs.
pub(crate) fn further_blocks(records: usize) -> u32 {
    // Every block but the last has a link in place of a record.
    records.saturating_sub(BLOCK).div_ceil(BLOCK - 1) as u32
}

/// Number of blocks of the pool to allocate for so many movers when `needed` blocks are needed. Each growth repeats a step and
/// copies all springs, so in large scenes the pool grows by at least 4 bytes per mover.
pub(crate) fn pool_for(needed: u32, movers: u32) -> u32 {
    let growth = (needed / 4).max(movers / 64).max(LEAST_GROWTH);
    if needed == 0 { 0 } else { needed.saturating_add(growth).min(largest_pool(movers)) }
}

/// Greatest number of blocks of the pool that links can name, beside a block per mover.
pub(crate) fn largest_pool(movers: u32) -> u32 {
    MAX_HISTORY_BLOCKS.saturating_sub(movers)
}

/// First word of the springs before the step, in a world.
pub(crate) fn first_word(world: &World) -> usize {
    world.status.history_table as usize * world.history_words()
}

/// The owner of a contact: the mover whose chain keeps its spring. It is the smaller of two spheres or of two rods, because a
/// sphere has few contacts with spheres that are not smaller. Of two equal ones it is the first if both insertion indices are
/// even or both are odd, and otherwise the second. A mover thus owns about half of its contacts with equal ones, which keeps
/// chains short. A sphere owns its contacts with rods.
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

/// The key of the other object of a contact in its owner's records.
pub(crate) fn key(view: &View, other: u32, feature: u32) -> u32 {
    view.insertion_index(other) << feature_bits(view.step) | feature
}

/// Bits of the feature in a key.
pub(crate) fn feature_bits(step: &Step) -> u32 {
    crate::model::layout::ENTRY_BITS - step.entry_id_bits()
}

/// A record.
pub(crate) fn pack(key: u32, spring: &Spring) -> Record {
    let Spring { shift, overlap, moment } = spring;
    let [x, y, z, w] = [shift.x, shift.y, shift.z, *overlap].map(f32::to_bits);
    let [p, q, r] = moment.to_array().map(f32::to_bits);
    [x, y, z, w, p, q, r, key]
}

fn unpack(words: &[u32]) -> Spring {
    let number = |place: usize| f32::from_bits(words[place]);
    let [shift, moment] = [0, 4].map(|place| Vec3::new(number(place), number(place + 1), number(place + 2)));
    Spring { shift, overlap: number(3), moment }
}
