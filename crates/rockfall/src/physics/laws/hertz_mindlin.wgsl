// requires physics/laws/stiffness.wgsl

// The law `hertz-mindlin`: S_n = 2 E* a and S_t = 8 G* a with the contact radius a = sqrt(R* d). `constants` are E*, G*, damping
// and friction of the pair.
fn hertz_mindlin_stiffness(constants: vec4f, radius: f32, overlap: f32) -> Stiffness {
    let a = sqrt(radius * overlap);
    return Stiffness(2.0 * a * constants.x, 8.0 * a * constants.y, 2.0 / 3.0, true);
}
