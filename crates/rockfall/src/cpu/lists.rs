//! Reading the pair lists.

use crate::layout::{ENTRY_FEATURE_MASK, ENTRY_ID_BITS, ENTRY_ID_MASK, SLICE, Step};

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
        let count = self.words[mover as usize];
        let first = slot(self.step, self.words, mover, 0);
        let entries = &self.words[self.step.entries_at as usize..];
        (0..count).map(move |place| {
            let slot = first + place * SLICE;
            Entry {
                slot,
                word: entries[slot as usize],
            }
        })
    }
}

/// Slot of entry `place` of a mover.
pub(crate) fn slot(step: &Step, lists: &[u32], mover: u32, place: u32) -> u32 {
    lists[(step.slices_at + mover / SLICE) as usize] + place * SLICE + mover % SLICE
}
