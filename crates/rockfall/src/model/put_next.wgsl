// requires model/step.wgsl

// Writes a row of the next state, which is a buffer of its own.
fn put_next(region: u32, i: u32, row: vec4f) {
    next[region * step.spheres + i] = row;
}
