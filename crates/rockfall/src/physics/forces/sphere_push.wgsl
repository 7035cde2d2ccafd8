// requires model/entries.wgsl model/step.wgsl physics/chain.wgsl physics/contact.wgsl physics/forces/net_force.wgsl
// requires physics/geometry.wgsl

// A contact of a sphere by the law of the thesis.

// Contact of a sphere with the object of an entry. The sphere is evaluated as A. The other object has a higher id or is also a
// sphere. Between spheres the contact law is symmetric, except for rounding errors of the slip.
fn push_of(i: u32, partner: u32, own: vec4f, side: Side, other: LoadedEntry) -> Push {
    let id = entry_id(other.entry);
    var found = no_touch();
    var their_side = sphere_side(other.place, other.velocity, other.momentum);
    if id < step.spheres {
        found = touch_two(i, own, id, other.place);
        if joined(i, partner, id) {
            return no_push();
        }
    } else {
        found = touch_static_or_rod(i, id, own);
        their_side = moving_side(other_side(id, found.b), i, id, found);
    }
    found = uncovered(i, id, found);
    // A position far outside of the range of f32 makes the overlap no number. That is no contact either.
    if !(found.overlap > 0.0) | (side.inverse_mass + their_side.inverse_mass <= 0.0) {
        return no_push();
    }
    let contact = contact_force(side, their_side, found, i, id);
    return Push(contact.force, contact.torque_per_arm, contact.arm_a, found.overlap);
}
