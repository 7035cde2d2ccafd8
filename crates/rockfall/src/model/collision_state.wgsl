// requires model/state_rows.wgsl model/step.wgsl

// The velocities of `state` in the phase of collisions: those at the time of the positions (docs/physics section 5.2).

fn velocity_at(sphere: u32) -> u32 {
    return select(1u, 4u, HALF_STEP) * step.spheres + sphere;
}

// The velocity row that the integrators read, after the phase of collisions has changed the velocity of a sphere.
fn own_velocity_after(sphere: u32, after: vec4f) -> vec4f {
    if HALF_STEP {
        let own = state[step.spheres + sphere];
        return vec4f(own.xyz + (after.xyz - state[velocity_at(sphere)].xyz), own.w);
    }
    return after;
}
