// requires model/step.wgsl

// Access to the four stage states of RK4, which are stored side by side in `state`. Each has three regions of one vec4 per
// sphere. The first one is the state itself.

// Index of the stage state whose forces are evaluated.
var<private> evaluated: u32;

fn state_row_at(stage: u32, region: u32, sphere: u32) -> u32 {
    return (3u * stage + region) * step.spheres + sphere;
}

fn position_at(sphere: u32) -> u32 {
    return state_row_at(evaluated, 0u, sphere);
}

fn velocity_at(sphere: u32) -> u32 {
    return state_row_at(evaluated, 1u, sphere);
}

fn momentum_at(sphere: u32) -> u32 {
    return state_row_at(evaluated, 2u, sphere);
}

// Not used: scenes with low parts of positions do not run here.
fn low_at(sphere: u32) -> u32 {
    return position_at(sphere);
}

fn evaluation() -> u32 {
    return evaluated;
}

fn start_row(region: u32, i: u32) -> vec4f {
    return state[state_row_at(0u, region, i)];
}

fn put_start(region: u32, i: u32, row: vec4f) {
    state[state_row_at(0u, region, i)] = row;
}

fn next_row(region: u32, i: u32) -> vec4f {
    return state[state_row_at(evaluated + 1u, region, i)];
}

fn put_next(region: u32, i: u32, row: vec4f) {
    state[state_row_at(evaluated + 1u, region, i)] = row;
}

fn y2_row(region: u32, i: u32) -> vec4f {
    return state[state_row_at(1u, region, i)];
}

fn y3_row(region: u32, i: u32) -> vec4f {
    return state[state_row_at(2u, region, i)];
}

fn y4_row(region: u32, i: u32) -> vec4f {
    return state[state_row_at(3u, region, i)];
}
