// requires model/step.wgsl physics/laws/stiffness.wgsl

// The law `linear`: springs of constant stiffness. `constants` are k_n, k_t, damping and friction of the pair. A negative k_n is
// -E*, and k_t is the characteristic velocity V, for which an elastic impact is as deep as by Hertz.
fn linear_stiffness(constants: vec4f, radius: f32, mass: f32) -> Stiffness {
    if constants.x >= 0.0 {
        return Stiffness(constants.x, constants.y, 1.0, 1.0);
    }
    let hertz = -constants.x * sqrt(radius);
    let root_of_depth = pow(15.0 / 16.0 * mass * constants.y * constants.y / hertz, 0.2);
    let stiffness = 16.0 / 15.0 * hertz * root_of_depth;
    return Stiffness(stiffness, TANGENTIAL_RATIO * stiffness, 1.0, 1.0);
}
