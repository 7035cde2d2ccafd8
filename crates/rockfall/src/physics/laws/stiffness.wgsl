// Stiffness of a contact at its present overlap (docs/physics section 4.11).
struct Stiffness {
    // Derivative of the elastic normal force by the overlap.
    normal: f32,
    // Tangential force per tangential displacement.
    tangential: f32,
    // Elastic normal force, as a fraction of `normal` times the overlap.
    share: f32,
    // While the contact unloads: tangential stiffness per that in the last step. The tangential displacement shrinks with it.
    // Otherwise 1.
    unloading: f32,
}

// What a law gives for a contact.
struct Answer {
    stiff: Stiffness,
    // Normal force N without cohesion, at least 0.
    press: f32,
    // Tangential force per tangential velocity.
    dashpot: f32,
}

// A contact of objects a and b.
struct LawContact {
    a: u32,
    b: u32,
    // The first two constants of the law, damping and friction of the pair.
    constants: vec4f,
    // R* and m*.
    radius: f32,
    mass: f32,
    overlap: f32,
    approach: f32,
    // That of the last step, not positive for a new contact.
    old_overlap: f32,
}

// The answer of a law whose damping follows from the stiffness.
fn springs_answer(stiff: Stiffness, contact: LawContact) -> Answer {
    let g = contact.constants.z;
    let dashpot = g * sqrt(stiff.normal * contact.mass);
    let press = max(0.0, stiff.share * stiff.normal * contact.overlap + dashpot * contact.approach);
    return Answer(stiff, press, g * sqrt(stiff.tangential * contact.mass));
}

// Derivatives of the normal force of such a law by the overlap and by the speed.
fn springs_slopes(stiff: Stiffness, contact: LawContact) -> vec2f {
    return vec2f(stiff.normal, contact.constants.z * sqrt(stiff.normal * contact.mass));
}
