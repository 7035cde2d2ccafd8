// requires model/entries.wgsl model/order.wgsl model/step.wgsl physics/chain.wgsl physics/collision/crossings.wgsl physics/contact.wgsl
// requires physics/forces/net_force.wgsl physics/geometry.wgsl physics/round_pair.wgsl

// A contact of a sphere by the law of the thesis.

// Whether the contact of a sphere began within the step. Then the next collision phase handles it, and it exerts no force
// (docs/physics section 3.10).
fn began_within_step(i: u32, own: vec4f, id: u32, their_radius: f32) -> bool {
    let pair = ordered(i, id);
    let radius = smaller_radius(own.w, their_radius, id < step.spheres + step.rods);
    let time = time_of_beginning(pair.x, pair.y, collision_velocity(radius, i, id));
    return (time >= 0.0) && !is_hidden_crossing(i, id, time);
}

// Contact of a sphere with the object of an entry. The sphere is evaluated as A. The other object has a higher id or is also a
// sphere. Between spheres the contact law is symmetric, except for rounding errors of the slip.
fn push_of(i: u32, partner: u32, own: vec4f, plain_side: Side, other: LoadedEntry) -> Push {
    let id = entry_id(other.entry);
    var side = plain_side;
    var found = no_touch();
    var their_side = sphere_side(other.place, other.velocity, other.momentum);
    if id < step.spheres {
        found = touch_two(i, own, id, other.place);
        if joined(i, partner, id) {
            return no_push();
        }
        if SHEARED {
            // The sphere that was added later has the velocity of its image, so that the forces on both are opposite to the bit.
            let is_first = ordered(i, id).x == i;
            their_side.velocity += select(vec3f(0.0), image_velocity(i, id), is_first);
            side.velocity += select(image_velocity(id, i), vec3f(0.0), is_first);
        }
    } else {
        found = touch_static_or_rod(i, id, own);
    }
    found = uncovered(i, id, found);
    if id >= step.spheres {
        their_side = moving_side(other_side(id, found.b), i, id, found);
    }
    // A position far outside of the range of f32 makes the overlap no number. That is no contact either.
    if !(found.overlap > 0.0) | (side.inverse_mass + their_side.inverse_mass <= 0.0) {
        return no_push();
    }
    if CONTINUOUS {
        if began_within_step(i, own, id, their_side.radius) {
            return Push(vec3f(0.0), vec3f(0.0), 0.0, found.overlap);
        }
    }
    let contact = contact_force(side, their_side, found, i, id);
    return Push(contact.force, contact.torque_per_arm, contact.arm_a, found.overlap);
}
