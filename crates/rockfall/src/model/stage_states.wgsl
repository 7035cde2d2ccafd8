// requires model/step.wgsl

// Access to the four stage states of RK4, each of which is a buffer of its own.

fn start_row(region: u32, i: u32) -> vec4f {
    return start[region * step.spheres + i];
}

fn put_start(region: u32, i: u32, row: vec4f) {
    start[region * step.spheres + i] = row;
}

fn y2_row(region: u32, i: u32) -> vec4f {
    return y2[region * step.spheres + i];
}

fn y3_row(region: u32, i: u32) -> vec4f {
    return y3[region * step.spheres + i];
}

fn y4_row(region: u32, i: u32) -> vec4f {
    return state[region * step.spheres + i];
}
