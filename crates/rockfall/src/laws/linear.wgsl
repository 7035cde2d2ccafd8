// requires physics/laws/stiffness.wgsl

// Ratio of the tangential to the normal stiffness.
const TANGENTIAL_RATIO: f32 = 2.0 / 7.0;

// The law `linear`: springs of constant stiffness. `constants` are k_n, k_t, damping and friction of the pair. A negative k_n
// is -E*, and k_t is the characteristic velocity V, for which an impact is as deep as that of elastic bodies.
fn linear_stiffness(contact: LawContact) -> Stiffness {
    let constants = contact.constants;
    if constants.x >= 0.0 {
        return Stiffness(constants.x, constants.y, 1.0, 1.0);
    }
    let elastic = -constants.x * sqrt(contact.radius);
    let root_of_depth = pow(15.0 / 16.0 * contact.mass * constants.y * constants.y / elastic, 0.2);
    let stiffness = 16.0 / 15.0 * elastic * root_of_depth;
    return Stiffness(stiffness, TANGENTIAL_RATIO * stiffness, 1.0, 1.0);
}

fn linear_answer(contact: LawContact) -> Answer {
    return springs_answer(linear_stiffness(contact), contact);
}

fn linear_slopes(contact: LawContact) -> vec2f {
    return springs_slopes(linear_stiffness(contact), contact);
}

fn linear_relative_force(overlap: f32) -> f32 {
    return max(overlap, 0.0);
}

fn linear_stiffness_by_force(ratio: f32) -> f32 {
    return 1.0;
}

fn linear_stiffness_by_overlap(ratio: f32) -> f32 {
    return 1.0;
}
