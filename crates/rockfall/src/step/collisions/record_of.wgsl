// requires model/lists.wgsl model/step.wgsl

// From entries of the pair lists to records.

// The record of the colliding entry in a slot.
fn record_of(slot: vec2u) -> u32 {
    return collision_indices[row_of_entries(slot)][slot.y];
}

// Whether the step lists its collisions.
fn are_listed() -> bool {
    return RODS | LARGE | (step.sweeps != SWEEPS_OFF);
}
