// requires physics/margin.wgsl step/take_next.wgsl

// Makes the next state of a sphere its current state, and requests a rebuild of the lists if the sphere may soon leave its
// AABB.
fn commit(i: u32) {
    take_next(i);
    ask_for_lists(i, next_row(0u, i), next_row(1u, i));
}
