// requires model/lists.wgsl

// Finds the records of list entries.

// The record of the colliding entry in a slot.
fn record_of(slot: vec2u) -> u32 {
    return collision_indices[row_of_entries(slot)][slot.y];
}

