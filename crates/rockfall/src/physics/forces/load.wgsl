// Force and torque on a sphere by its contacts, then by what is attached to it: rods, springs, tethers, and an external force
// (docs/physics section 4).
struct Load {
    force: vec3f,
    torque: vec3f,
}
