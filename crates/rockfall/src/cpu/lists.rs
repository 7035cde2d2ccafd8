//! Reading the pair lists.

use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::view::View;
use crate::layout::{ENTRY_FEATURE_MASK, ENTRY_ID_BITS, ENTRY_ID_MASK, LIST_COLLIDES, LIST_COUNT_MASK, SLICE, Step};

/// One entry of a mover's list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Place among the entries, and of its weight.
    pub(crate) slot: u32,
    pub(crate) word: u32,
}

impl Entry {
    /// Id of the other object.
    pub(crate) fn id(self) -> u32 {
        self.word & ENTRY_ID_MASK
    }

    /// Which of the possible contacts of a rod and a box.
    pub(crate) fn feature(self) -> u32 {
        self.word >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK
    }
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

    /// The list of a mover, in its canonical order.
    pub(crate) fn row(&self, mover: u32) -> impl Iterator<Item = Entry> + use<'a> {
        let count = self.words[mover as usize] & LIST_COUNT_MASK;
        let first = slot(self.step, self.words, mover, 0);
        let entries = &self.words[self.step.entries_at as usize..];
        (0..count).map(move |place| {
            let slot = first + place * SLICE;
            Entry { slot, word: entries[slot as usize] }
        })
    }

    /// Whether some entry of a mover collides.
    pub(crate) fn collides(&self, mover: u32) -> bool {
        self.words[mover as usize] & LIST_COLLIDES != 0
    }
}

/// Puts a mover's entries into their canonical order: by index in order of addition, then feature.
pub(crate) fn put_in_order(view: &View, entries: &mut [u32]) {
    entries.sort_unstable_by_key(|entry| (view.user(entry & ENTRY_ID_MASK), entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK));
}

/// Slot of entry `place` of a mover.
pub(crate) fn slot(step: &Step, lists: &[u32], mover: u32, place: u32) -> u32 {
    lists[(step.slices_at + mover / SLICE) as usize] + place * SLICE + mover % SLICE
}

/// Writes every mover's entries, which `entries` hands to the function it is given. Slices are filled side by side; they
/// must stand in ascending order.
pub(crate) fn fill_slices(step: &Step, lists: &mut [u32], entries: impl Fn(u32, &mut dyn FnMut(u32)) + Sync) {
    let movers = step.spheres + step.rods;
    let (index, mut rest) = lists.split_at_mut(step.entries_at as usize);
    let (counts, offsets) = index.split_at(step.slices_at as usize);
    let slices: Vec<&mut [u32]> = counts
        .chunks(SLICE as usize)
        .zip(offsets)
        .map(|(counts, _)| {
            let words = counts.iter().max().copied().unwrap_or(0) * SLICE;
            rest.split_off_mut(..words as usize).unwrap_or_default()
        })
        .collect();
    slices.into_par_iter().enumerate().with_min_len(GRAIN / SLICE as usize).for_each(|(slice, words)| {
        let slice = slice as u32;
        for mover in slice * SLICE..movers.min((slice + 1) * SLICE) {
            let mut at = (mover % SLICE) as usize;
            entries(mover, &mut |entry| {
                words[at] = entry;
                at += SLICE as usize;
            });
        }
    });
}
