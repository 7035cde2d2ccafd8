// requires model/lists.wgsl model/step.wgsl

// Finds the records of list entries.

// The record of the colliding entry in a slot.
fn record_of(slot: vec2u) -> u32 {
    return collision_indices[row_of_entries(slot)][slot.y];
}

// Whether the collisions of the step have records.
fn are_listed() -> bool {
    return RODS | LARGE | (step.sweeps != SWEEPS_OFF);
}
