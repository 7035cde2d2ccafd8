// requires model/lists.wgsl model/step.wgsl physics/contact.wgsl

// Number of pressed contacts in the list of a mover.
fn pressed_in(row: u32) -> u32 {
    let count = count_of(row);
    let first = first_of(row);
    var found = 0u;
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        found += countOneBits(entries_with(ENTRY_OVERLAPS, first, begin, count));
    }
    return found;
}
