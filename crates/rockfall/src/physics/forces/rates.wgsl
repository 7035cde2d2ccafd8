// Rates of change of a moving sphere.
struct Rates {
    // Of its velocity, in units/s^2.
    acceleration: vec3f,
    // Of its angular momentum, in mass units^2/s^2.
    torque: vec3f,
}
