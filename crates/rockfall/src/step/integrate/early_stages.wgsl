// What stage states 2 and 3 contribute to the state of a sphere at the end of the step, in the stages that read them from memory.

// Their part of the sum for a vector: velocity or angular momentum, by region. `y` is its value at the start.
fn early_changes(region: u32, i: u32, y: vec3f) -> vec3f {
    return (y2_row(region, i).xyz - y) + 2.0 * (y3_row(region, i).xyz - y);
}

// Their part of the sum for the mean velocity. `start` is the velocity at the start.
fn early_velocities(i: u32, start: vec3f) -> vec3f {
    return 2.0 * ((y2_row(1u, i).xyz - start) + (y3_row(1u, i).xyz - start));
}

// Their part of the sum for the mean angular momentum, and that of the start.
fn early_momenta(i: u32, start: vec3f) -> vec3f {
    return start + 2.0 * y2_row(2u, i).xyz + 2.0 * y3_row(2u, i).xyz;
}
