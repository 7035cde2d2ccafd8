// requires model/step.wgsl physics/laws/stiffness.wgsl physics/pairs.wgsl

// The law that the program defines (docs/physics section 4.15).

// Distance over which the normal stiffness is found, per overlap.
const USER_REACH: f32 = 0.01;

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

fn user_contact(contact: LawContact) -> UserContact {
    let constants = contact.constants;
    return UserContact(contact.overlap, contact.approach, contact.radius, contact.mass, constants.x, constants.y);
}

fn user_answer(contact: LawContact) -> Answer {
    let pair = pair_number(contact.a, contact.b);
    let now = user_contact(contact);
    let found = user_response(pair, now);
    var stiff = Stiffness(0.0, at_least_zero(found.tangential), 0.0, 1.0);
    if contact.overlap < contact.old_overlap {
        var before = now;
        before.overlap = contact.old_overlap;
        let old = user_response(pair, before).tangential;
        stiff.unloading = select(1.0, stiff.tangential / old, old > stiff.tangential);
    }
    if RESISTANCE {
        let reach = USER_REACH * contact.overlap;
        let more = user_elastic(pair, now, contact.overlap + reach);
        stiff.normal = at_least_zero((more - user_elastic(pair, now, contact.overlap - reach)) / (2.0 * reach));
    }
    return Answer(stiff, at_least_zero(found.normal), at_least_zero(found.damping));
}

fn user_press(contact: LawContact, overlap: f32, approach: f32) -> f32 {
    var other = contact;
    other.overlap = overlap;
    other.approach = approach;
    return user_answer(other).press;
}

// The program gives a force alone. Its slopes are found from differences.
fn user_slopes(contact: LawContact) -> vec2f {
    let overlap = contact.overlap;
    let approach = contact.approach;
    let reach = 0.01 * overlap;
    let speed = reach / step.dt;
    let by_overlap = user_press(contact, overlap + reach, approach) - user_press(contact, overlap - reach, approach);
    let by_speed = user_press(contact, overlap, approach + speed) - user_press(contact, overlap, approach - speed);
    return max(vec2f(0.0), 0.5 * vec2f(by_overlap, by_speed) / vec2f(reach, speed));
}

// Contacts share no springs.
fn user_relative_force(overlap: f32) -> f32 {
    return 0.0;
}

fn user_stiffness_by_force(ratio: f32) -> f32 {
    return 1.0;
}

fn user_stiffness_by_overlap(ratio: f32) -> f32 {
    return 1.0;
}
