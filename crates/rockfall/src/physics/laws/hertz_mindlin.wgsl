// requires physics/laws/stiffness.wgsl

// The law `hertz-mindlin`: S_n = 2 E* a and S_t = 8 G* a with the contact radius a = sqrt(R* d). `constants` are E*, G*, damping
// and friction of the pair. `old_overlap` is that of the last step, not positive for a new contact.
fn hertz_mindlin_stiffness(constants: vec4f, radius: f32, overlap: f32, old_overlap: f32) -> Stiffness {
    let a = sqrt(radius * overlap);
    var unloading = 1.0;
    if overlap < old_overlap {
        unloading = sqrt(overlap / old_overlap);
    }
    return Stiffness(2.0 * a * constants.x, 8.0 * a * constants.y, 2.0 / 3.0, unloading);
}
