// requires model/step.wgsl

// Access to the state and the next state, each of which is a buffer of its own.

fn put_start(region: u32, i: u32, row: vec4f) {
    state[region * step.spheres + i] = row;
}

fn next_row(region: u32, i: u32) -> vec4f {
    return next[region * step.spheres + i];
}
