// requires model/step.wgsl

// How the pair lists are read. They stand in rows of SLICE words, for their words may be more than 32 bits can number.

// A word before the entries. By its mover, the head of a list: how many entries it has, and LIST_* bits; from `slices_at` on, the
// rows in which slices begin.
fn head_of(mover: u32) -> u32 {
    return lists[mover / SLICE][mover % SLICE];
}

// Entries in a mover's list.
fn count_of(mover: u32) -> u32 {
    return head_of(mover) & LIST_COUNT_MASK;
}

// Slot of the first entry of a mover: its row, and its place in the row.
fn first_of(mover: u32) -> vec2u {
    return vec2u(step.entries_at / SLICE + head_of(step.slices_at + mover / SLICE), mover % SLICE);
}

// Slot of entry e of the list whose first is there.
fn slot_at(first: vec2u, e: u32) -> vec2u {
    return vec2u(first.x + e, first.y);
}

fn slot_of(mover: u32, e: u32) -> vec2u {
    return slot_at(first_of(mover), e);
}

fn entry_at(slot: vec2u) -> u32 {
    return lists[slot.x][slot.y];
}

// Row, among those of entries alone, of a slot.
fn row_of_entries(slot: vec2u) -> u32 {
    return slot.x - step.entries_at / SLICE;
}
