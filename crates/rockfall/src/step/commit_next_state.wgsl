// requires model/step.wgsl

// Makes the next state of a sphere its current state.
fn commit_next_state(i: u32) {
    for (var region = 0u; region < STATE_REGIONS; region++) {
        put_start(region, i, next_row(region, i));
    }
}
