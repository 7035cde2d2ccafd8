// requires model/step.wgsl

// Offsets of a sphere's rows in `state` and `next`, for the phase of collisions. Its velocities are those at the time of the
// positions (docs/physics.md section 5.2).

fn position_at(sphere: u32) -> u32 {
    return sphere;
}

fn velocity_at(sphere: u32) -> u32 {
    return select(1u, 4u, HALF_STEP) * step.spheres + sphere;
}

fn momentum_at(sphere: u32) -> u32 {
    return 2u * step.spheres + sphere;
}

fn low_at(sphere: u32) -> u32 {
    return 3u * step.spheres + sphere;
}

fn low_row(sphere: u32) -> vec3f {
    return state[low_at(sphere)].xyz;
}

fn evaluation() -> u32 {
    return pass_.index;
}

// The velocity row that the integrators read, after the phase of collisions has changed the velocity of a sphere.
fn own_velocity_after(sphere: u32, after: vec4f) -> vec4f {
    if HALF_STEP {
        let own = state[step.spheres + sphere];
        return vec4f(own.xyz + (after.xyz - state[velocity_at(sphere)].xyz), own.w);
    }
    return after;
}
