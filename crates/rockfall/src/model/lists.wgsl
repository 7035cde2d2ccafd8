// requires model/step.wgsl

// Read access to the pair lists. They are an array of rows of SLICE words, because 32 bits may be too few to number the words.

// A word of the part before the entries. Below `slices_at` it is the head of the mover's list: the number of entries and LIST_*
// bits. From `slices_at` on it is the row in which a slice starts.
fn head_of(mover: u32) -> u32 {
    return lists[mover / SLICE][mover % SLICE];
}

// Number of entries in a mover's list.
fn count_of(mover: u32) -> u32 {
    return head_of(mover) & LIST_COUNT_MASK;
}

// Slot of the first entry of a mover: the row, and the place in the row.
fn first_of(mover: u32) -> vec2u {
    return vec2u(step.entries_at / SLICE + head_of(step.slices_at + mover / SLICE), mover % SLICE);
}

// Slot of entry e of a list whose first entry is in slot `first`.
fn slot_at(first: vec2u, e: u32) -> vec2u {
    return vec2u(first.x + e, first.y);
}

fn slot_of(mover: u32, e: u32) -> vec2u {
    return slot_at(first_of(mover), e);
}

fn entry_at(slot: vec2u) -> u32 {
    return lists[slot.x][slot.y];
}

// Row of a slot, counted from the first row of entries.
fn row_of_entries(slot: vec2u) -> u32 {
    return slot.x - step.entries_at / SLICE;
}
