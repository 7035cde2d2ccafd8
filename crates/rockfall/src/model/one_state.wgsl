// requires model/step.wgsl

// Offsets of a sphere's rows in `state`, the state that the pass evaluates. It has STATE_REGIONS regions of one vec4 per
// sphere.

fn position_at(sphere: u32) -> u32 {
    return sphere;
}

fn velocity_at(sphere: u32) -> u32 {
    return step.spheres + sphere;
}

fn momentum_at(sphere: u32) -> u32 {
    return 2u * step.spheres + sphere;
}

// The fourth region holds the low parts of the positions.
fn low_at(sphere: u32) -> u32 {
    return 3u * step.spheres + sphere;
}

// The low part of the position of a sphere.
fn low_row(sphere: u32) -> vec3f {
    return state[low_at(sphere)].xyz;
}

// Index of the force evaluation within the step.
fn evaluation() -> u32 {
    return pass_.index;
}
