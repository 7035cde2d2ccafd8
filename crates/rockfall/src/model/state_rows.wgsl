// requires model/step.wgsl

// Offsets of the rows of `state` that all phases read at the same place: one vec4 per sphere in each region.

fn position_at(sphere: u32) -> u32 {
    return sphere;
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

// The row of a sphere in a region of residues.
fn residue_row(region: u32, sphere: u32) -> vec4f {
    return state[region * step.spheres + sphere];
}

// Index of the force evaluation within the step.
fn evaluation() -> u32 {
    return pass_.index % EARLY;
}
