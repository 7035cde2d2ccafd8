// Rates of change of a moving sphere.
struct Rates {
    // Rate of change of the velocity, in units/s^2.
    acceleration: vec3f,
    // Rate of change of the angular momentum, in mass units^2/s^2.
    torque: vec3f,
}
