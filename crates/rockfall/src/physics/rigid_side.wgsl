// requires model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/forces/net_force.wgsl physics/round_pair.wgsl physics/rigid.wgsl
// requires physics/rigid_box.wgsl physics/rigid_lever.wgsl physics/rigid_parts.wgsl

// The side of an object in a contact with another one, with the mass and inertia of the rigid body that it belongs to, if any. `at` is the
// parameter on a rod.
fn in_body(half: Side, id: u32, at: f32, other: u32, found: Touch) -> Side {
    if !RIGID_BODIES {
        return half;
    }
    let body = rigid_body_of(id);
    if body == NO_RIGID {
        return half;
    }
    let record = rigid_record(body);
    var lever = lever_on_body(record, id, at);
    var whole = half;
    let word = box_word(id);
    if is_solid(word) {
        let from_centre = core_point(id, other, word, found);
        lever += from_centre;
        whole.velocity += cross(half.spin, from_centre);
        whole.radius = float_at(word + 3u);
    }
    let across = cross(lever, found.n);
    let reach = 1.0 + length(lever) / whole.radius;
    whole.inverse_mass = float_at(record + 3u) + dot(across, by_inverse_inertia(record, across));
    whole.inverse_inertia = reach * reach * float_at(record + 10u);
    return whole;
}

// The effect of a contact on an object with the torque about its centre: the force on a solid acts at the point of its core.
fn about_centre(push: Push, id: u32, other: u32, found: Touch) -> Push {
    if !RIGID_BODIES {
        return push;
    }
    let word = box_word(id);
    if !is_solid(word) {
        return push;
    }
    let torque = push.arm * push.torque_per_arm + cross(core_point(id, other, word, found), push.force);
    return Push(push.force, torque, 1.0, push.overlap);
}
