// requires model/state_rows.wgsl model/step.wgsl

// The velocities of `state`, the state that the pass evaluates. It has STATE_REGIONS regions of one vec4 per sphere.

fn velocity_at(sphere: u32) -> u32 {
    return step.spheres + sphere;
}
