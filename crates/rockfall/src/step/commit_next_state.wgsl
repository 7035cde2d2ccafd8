// Makes the next state of a sphere its current state. After the phase of collisions, with symplectic Euler, there is a fifth region.
fn commit_next_state(i: u32, regions: u32) {
    for (var region = 0u; region < regions; region++) {
        put_start(region, i, next_row(region, i));
    }
}
