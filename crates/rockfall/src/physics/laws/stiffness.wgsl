// Stiffness of a contact at its present overlap (docs/physics.md section 4.11).
struct Stiffness {
    // Derivative of the elastic normal force by the overlap.
    normal: f32,
    // Tangential force per tangential displacement.
    tangential: f32,
    // Elastic normal force, as a fraction of `normal` times the overlap.
    share: f32,
    // Whether the tangential displacement shrinks with the square root of the overlap when the contact unloads.
    rescales: bool,
}
