// requires model/objects.wgsl model/step.wgsl physics/forces/attached.wgsl

// Acceleration of a moving sphere by gravity, springs, tethers and external forces.
fn free_acceleration(sphere: u32) -> vec3f {
    var force = vec3f(0.0);
    let range = adjacency(sphere);
    for (var at = range.x; at < range.y; at++) {
        let kind = kind_of(topology[at]);
        if !RODS | (kind != KIND_ROD) {
            force += attached_force(sphere, kind, index_of(topology[at]));
        }
    }
    return step.gravity + inverse_mass(sphere) * force;
}
