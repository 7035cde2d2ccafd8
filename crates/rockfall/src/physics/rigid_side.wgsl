// requires model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/round_pair.wgsl physics/rigid.wgsl
// requires physics/rigid_lever.wgsl physics/rigid_parts.wgsl

// The side of an object in a contact, with the mass and inertia of the rigid body that it belongs to, if any. `at` is the
// parameter on a rod.
fn in_body(half: Side, id: u32, at: f32, found: Touch) -> Side {
    if !RIGID_BODIES {
        return half;
    }
    let body = rigid_body_of(id);
    if body == NO_RIGID {
        return half;
    }
    let record = rigid_record(body);
    let lever = lever_on_body(record, id, at);
    var whole = half;
    let across = cross(lever, found.n);
    let reach = 1.0 + length(lever) / whole.radius;
    whole.inverse_mass = float_at(record + 3u) + dot(across, by_inverse_inertia(record, across));
    whole.inverse_inertia = reach * reach * float_at(record + 10u);
    return whole;
}
