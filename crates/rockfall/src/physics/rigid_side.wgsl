// requires model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/rigid.wgsl

// The side of a contact with the mass and inertia of the rigid body that an object belongs to, if any. `at` is the parameter on a rod.
fn in_body(half: Side, id: u32, at: f32, n: vec3f) -> Side {
    if !RIGID_BODIES {
        return half;
    }
    let body = rigid_body_of(id);
    if body == NO_RIGID {
        return half;
    }
    var place = vec3f(0.0);
    if id < step.spheres {
        place = state[position_at(id)].xyz;
    } else {
        let ends = rod_ends(id - step.spheres);
        place = mix(state[position_at(ends.x)].xyz, state[position_at(ends.y)].xyz, at);
    }
    let record = rigid_record(body);
    let lever = place - vector_at(record);
    let across = cross(lever, n);
    let reach = 1.0 + length(lever) / half.radius;
    var whole = half;
    whole.inverse_mass = float_at(record + 3u) + dot(across, by_inverse_inertia(record, across));
    whole.inverse_inertia = reach * reach * float_at(record + 10u);
    return whole;
}
