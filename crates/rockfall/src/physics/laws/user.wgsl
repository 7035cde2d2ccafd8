// requires model/step.wgsl physics/laws/stiffness.wgsl

// The law that the program defines (docs/physics section 4.15).

// Overlap, speed of approach, R*, m*, E* and G*.
struct UserContact {
    overlap: f32,
    speed: f32,
    radius: f32,
    mass: f32,
    young: f32,
    shear: f32,
}

// Normal force, tangential stiffness and tangential damping.
struct Response {
    normal: f32,
    tangential: f32,
    damping: f32,
}

// The response of the contact of a pair of materials, by its number. In simulations with such a law, user_laws/set.rs replaces
// this function.
fn user_response(pair: u32, contact: UserContact) -> Response {
    return Response(0.0, 0.0, 0.0);
}

// The larger of a number and 0, and what is not a number as it is: max() may lose it.
fn at_least_zero(number: f32) -> f32 {
    let exponent = bitcast<u32>(number) & 0x7f800000u;
    return select(max(0.0, number), number, exponent == 0x7f800000u);
}

// Elastic normal force at an overlap.
fn user_elastic(pair: u32, contact: UserContact, overlap: f32) -> f32 {
    var other = contact;
    other.overlap = overlap;
    other.speed = 0.0;
    return at_least_zero(user_response(pair, other).normal);
}

// The law at the present overlap. `old_overlap` is that of the last step, not positive for a new contact.
fn user_law(pair: u32, contact: UserContact, old_overlap: f32) -> Answer {
    let found = user_response(pair, contact);
    var stiff = Stiffness(0.0, at_least_zero(found.tangential), 0.0, 1.0);
    if contact.overlap < old_overlap {
        var before = contact;
        before.overlap = old_overlap;
        let old = user_response(pair, before).tangential;
        stiff.unloading = select(1.0, stiff.tangential / old, old > stiff.tangential);
    }
    if RESISTANCE {
        let reach = USER_REACH * contact.overlap;
        let more = user_elastic(pair, contact, contact.overlap + reach);
        stiff.normal = at_least_zero((more - user_elastic(pair, contact, contact.overlap - reach)) / (2.0 * reach));
    }
    return Answer(stiff, at_least_zero(found.normal), at_least_zero(found.damping));
}
