// requires physics/laws/stiffness.wgsl

// The law `hertz-mindlin`: S_n = 2 E* a and S_t = 8 G* a with the contact radius a = sqrt(R* d). `constants` are E*, G*,
// damping and friction of the pair.
fn hertz_mindlin_stiffness(contact: LawContact) -> Stiffness {
    let a = sqrt(contact.radius * contact.overlap);
    var unloading = 1.0;
    if contact.overlap < contact.old_overlap {
        unloading = sqrt(contact.overlap / contact.old_overlap);
    }
    return Stiffness(2.0 * a * contact.constants.x, 8.0 * a * contact.constants.y, 2.0 / 3.0, unloading);
}

fn hertz_mindlin_answer(contact: LawContact) -> Answer {
    return springs_answer(hertz_mindlin_stiffness(contact), contact);
}

fn hertz_mindlin_slopes(contact: LawContact) -> vec2f {
    return springs_slopes(hertz_mindlin_stiffness(contact), contact);
}

fn hertz_mindlin_relative_force(overlap: f32) -> f32 {
    let depth = max(overlap, 0.0);
    return depth * sqrt(depth);
}

fn hertz_mindlin_stiffness_by_force(ratio: f32) -> f32 {
    return pow(ratio, 1.0 / 3.0);
}

fn hertz_mindlin_stiffness_by_overlap(ratio: f32) -> f32 {
    return sqrt(ratio);
}
