// requires model/step.wgsl physics/escape.wgsl step/commit_next_state.wgsl

// Makes the next state of a sphere its current state, and requests a rebuild of the lists if the sphere may soon leave its
// AABB.
fn commit(i: u32) {
    commit_next_state(i, STATE_REGIONS);
    request_rebuild(i, next_row(0u, i), next_row(1u, i));
}
