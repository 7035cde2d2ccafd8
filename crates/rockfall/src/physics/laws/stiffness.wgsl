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
