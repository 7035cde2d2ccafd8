//! Reading the pair lists.

use rayon::prelude::*;

use crate::model::lanes::LANES;
use crate::model::layout::GRAIN;
use crate::model::layout::{ENTRY_BITS, FEATURE_BITS, LIST_COLLIDES, LIST_COUNT_MASK, SLICE};
use crate::model::step::Step;
use crate::model::view::View;

/// One entry of a mover's list.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Entry {
    /// Place in the list.
    pub(crate) place: u32,
    pub(crate) word: u32,
    id: u32,
}

impl Entry {
    /// Splits an entry. `id_mask` is [`Step::entry_id_mask`].
    pub(crate) fn new(id_mask: u32, place: u32, word: u32) -> Self {
        Self { place, word, id: word & id_mask }
    }

    /// Id of the other object.
    pub(crate) fn id(self) -> u32 {
        self.id
    }

    /// Which of the possible contacts of a rod and a box this entry is.
    pub(crate) fn feature(self) -> u32 {
        feature_of(self.word ^ self.id)
    }
}

/// Returns the feature of an entry whose id bits are 0.
fn feature_of(without_id: u32) -> u32 {
    (without_id & ((1 << ENTRY_BITS) - 1)) >> (ENTRY_BITS - FEATURE_BITS)
}

/// The pair lists.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a> {
    step: &'a Step,
    words: &'a [u32],
}

impl<'a> Lists<'a> {
    pub(crate) fn new(step: &'a Step, words: &'a [u32]) -> Self {
        Self { step, words }
    }

    /// Returns the list of a mover, in its canonical order (see [`put_in_order`]).
    pub(crate) fn row(&self, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
        let (count, list) = self.list(mover);
        (0..count).map(list)
    }

    /// Returns the length of a mover's list, and a function from a place in the list to the entry.
    pub(crate) fn list(&self, mover: u32) -> (u32, impl Fn(u32) -> Entry + use<'a>) {
        let count = self.words[mover as usize] & LIST_COUNT_MASK;
        let first = self.step.layout.entries_at as usize + slot(self.step, self.words, mover, 0);
        // `first` may be past the end when the list belongs to an empty slice.
        let words = self.words.get(first..).unwrap_or_default();
        let id_mask = self.step.entry_id_mask();
        (count, move |place| Entry::new(id_mask, place, words[(place * SLICE) as usize]))
    }

    /// Whether some entry of a mover collides.
    pub(crate) fn collides(&self, mover: u32) -> bool {
        self.words[mover as usize] & LIST_COLLIDES != 0
    }
}

/// Lists up to this length are sorted by comparing every entry with every other, which needs no branches.
const SHORT: usize = 24;

/// Sorts the entries of a mover into their canonical order: by insertion index, then by feature. No two entries may be equal.
pub(crate) fn put_in_order(view: &View, entries: &mut [u32]) {
    // Keys have ENTRY_BITS bits, so they fit signed numbers, which SSE2 can compare.
    let (mask, bits) = (view.step.entry_id_mask(), ENTRY_BITS - view.step.entry_id_bits());
    let key = |entry: u32| (view.insertion_index(entry & mask) << bits | feature_of(entry & !mask)) as i32;
    if entries.len() > SHORT {
        return entries.sort_unstable_by_key(|entry| key(*entry));
    }
    let (mut keys, mut unsorted) = ([i32::MAX; SHORT], [0; SHORT]);
    let len = entries.len();
    unsorted[..len].copy_from_slice(entries);
    keys.iter_mut().zip(&*entries).for_each(|(place, entry)| *place = key(*entry));
    let compared = &keys[..len.next_multiple_of(LANES)];
    for (entry, key) in unsorted.iter().zip(keys).take(len) {
        let rank: i32 = compared.iter().map(|other| i32::from(*other < key)).sum();
        entries[rank as usize] = *entry;
    }
}

/// Returns the slot of entry `place` of a mover: the index of its word within the words of all entries.
pub(crate) fn slot(step: &Step, lists: &[u32], mover: u32, place: u32) -> usize {
    let row = lists[(step.layout.slices_at + mover / SLICE) as usize] + place;
    row as usize * SLICE as usize + (mover % SLICE) as usize
}

/// The lists of neighbouring movers, for writing.
pub(crate) struct Slice<'a> {
    /// The first of the movers.
    pub(crate) first: u32,
    /// The lengths of their lists, without the words that pad the last slice.
    pub(crate) counts: &'a mut [u32],
    /// Their entries. Entry e of the mover at place p of the slice is word `32 e + p`.
    pub(crate) words: &'a mut [u32],
}

/// Splits the lists into slices that can be written in parallel. The slice offsets must ascend.
pub(crate) fn slices<'a>(step: &Step, lists: &'a mut [u32]) -> Vec<Slice<'a>> {
    let movers = (step.layout.spheres + step.layout.rods) as usize;
    let (index, mut rest) = lists.split_at_mut(step.layout.entries_at as usize);
    let (counts, offsets) = index.split_at_mut(step.layout.slices_at as usize);
    let counts = counts[..movers].chunks_mut(SLICE as usize);
    let last = counts.len() - usize::from(counts.len() > 0);
    let slice = |(number, counts): (usize, &'a mut [u32])| {
        // The width comes from the offsets, not from the counts: a slice may be wider than its longest list.
        let end = if number < last {
            offsets[number + 1].saturating_sub(offsets[number]) as usize * SLICE as usize
        } else {
            rest.len()
        };
        let words = rest.split_off_mut(..end).unwrap_or_default();
        Slice { first: number as u32 * SLICE, counts, words }
    };
    counts.enumerate().map(slice).collect()
}

/// Writes the entries of every mover. `entries` gets a mover and a function, which it calls with each entry of that mover.
pub(crate) fn fill_slices(step: &Step, lists: &mut [u32], entries: impl Fn(u32, &mut dyn FnMut(u32)) + Sync) {
    slices(step, lists).into_par_iter().with_min_len(GRAIN / SLICE as usize).for_each(|slice| {
        for place in 0..slice.counts.len() {
            let mover = slice.first + place as u32;
            let mut slot = place;
            entries(mover, &mut |entry| {
                slice.words[slot] = entry;
                slot += SLICE as usize;
            });
        }
    });
}
