// requires model/step.wgsl

// Where the rows of a sphere stand in `state`, the state that the pass evaluates: three regions of one vec4 a sphere.

fn position_at(sphere: u32) -> u32 {
    return sphere;
}

fn velocity_at(sphere: u32) -> u32 {
    return step.spheres + sphere;
}

fn momentum_at(sphere: u32) -> u32 {
    return 2u * step.spheres + sphere;
}

// Which force evaluation of the step this is.
fn evaluation() -> u32 {
    return pass_.index;
}
