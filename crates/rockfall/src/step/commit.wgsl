// requires physics/margin.wgsl step/take_next.wgsl

// The state that `symplectic_euler` made becomes the state of a sphere.

fn commit(i: u32) {
    take_next(i);
    ask_for_lists(i, next_row(0u, i), next_row(1u, i));
}
