// requires physics/laws/stiffness.wgsl

// The law `linear`: springs of constant stiffness. `constants` are k_n, k_t, damping and friction of the pair.
fn linear_stiffness(constants: vec4f) -> Stiffness {
    return Stiffness(constants.x, constants.y, 1.0, false);
}
