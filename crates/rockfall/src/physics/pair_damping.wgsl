// requires laws/chosen.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/quaternion.wgsl physics/rigid.wgsl
// requires physics/rigid_form.wgsl physics/rigid_parts.wgsl

// Damping of the contacts of the spheres of two bodies, at least one of which is a rigid body (docs/physics section 4.16).
//
// The places of the other spheres follow from those of the two that touch, the orientations and the forms of the bodies: forms are few, so
// reading them is much faster than reading the spheres.

// A rigid body, or a sphere of its own.
struct Party {
    // First word of the record of a rigid body, or NONE.
    record: u32,
    count: u32,
    inverse_mass: f32,
    // Greatest distance of a point of a sphere from the centre.
    reach: f32,
    orientation: vec4f,
    // First word of the places in the form, and of the members.
    places: u32,
    members: u32,
    // The sphere that touches: its radius, its number among the members, and its place from the centre.
    radius: f32,
    own: u32,
    own_place: vec3f,
}

fn party_of(sphere: u32) -> Party {
    let body = body_of_sphere(sphere);
    if body == NO_RIGID {
        let place = state[position_at(sphere)];
        return Party(NONE, 1u, inverse_mass(sphere), place.w, vec4f(0.0), 0u, 0u, place.w, 0u, vec3f(0.0));
    }
    let record = rigid_record(body);
    let places = topology[record + 11u] + SHAPE_WORDS;
    let count = topology[record + 13u];
    let members = topology[record + 12u];
    var party = Party(
        record, count, float_at(record + 3u), float_at(record + 18u), orientation_in(record), places, members, 0.0, 0u, vec3f(0.0)
    );
    let index = insertion_index(sphere);
    while (party.own + 1u < count) && (topology[members + party.own] != index) {
        party.own++;
    }
    party.radius = radius_of_member(party, party.own);
    party.own_place = place_in(party, party.own);
    return party;
}

// The place of a member from the centre of the body.
fn place_in(party: Party, k: u32) -> vec3f {
    if party.record == NONE {
        return vec3f(0.0);
    }
    return turned_vector(party.orientation, vector_at(party.places + 3u * k));
}

// The radius of a member.
fn radius_of_member(party: Party, k: u32) -> f32 {
    if party.record == NONE {
        return party.radius;
    }
    return float_at(party.members + party.count + k);
}

// A torque times the inverse inertia times itself.
fn turning(party: Party, torque: vec3f) -> f32 {
    if party.record == NONE {
        return 0.0;
    }
    return dot(torque, by_inverse_inertia(party.record, torque));
}

// The sums over the contacts of two parties.
struct Sums {
    // kappa o, kappa o^2
    sums: vec2f,
    force: vec3f,
    torque_a: vec3f,
    torque_b: vec3f,
}

// Factor of the damping of the contact of spheres a and b with the overlap o, the normal n and the inverse mass w.
fn pair_damping(a: u32, b: u32, o: f32, n: vec3f, w: f32) -> f32 {
    let one = party_of(a);
    let other = party_of(b);
    let apart = (one.radius + other.radius - o) * n;
    let reduced = one.radius * other.radius / (one.radius + other.radius);
    var total = Sums(vec2f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    for (var k = 0u; k < one.count; k++) {
        let lever = place_in(one, k);
        let radius = radius_of_member(one, k);
        let seen = apart - (lever - one.own_place);
        let to_centre = seen - other.own_place;
        if (dot(to_centre, to_centre) > (other.reach + radius) * (other.reach + radius)) & (k != one.own) {
            continue;
        }
        for (var l = 0u; l < other.count; l++) {
            let lever_b = place_in(other, l);
            let radii = vec2f(radius, radius_of_member(other, l));
            let is_own = (k == one.own) & (l == other.own);
            let d = seen + (lever_b - other.own_place);
            if (dot(d, d) > (radii.x + radii.y) * (radii.x + radii.y)) & !is_own {
                continue;
            }
            var met = vec4f(n, o);
            if !is_own {
                let distance = length(d);
                met = vec4f(d / max(distance, TINY), radii.x + radii.y - distance);
            }
            if !(met.w > 0.0) {
                continue;
            }
            let torque_a = cross(lever, met.xyz);
            let torque_b = cross(lever_b, met.xyz);
            let kappa = law_stiffness_by_overlap(radii.x * radii.y / (radii.x + radii.y) / reduced * met.w / o);
            let push = kappa * met.w;
            total.sums += push * vec2f(1.0, met.w);
            total.force += push * met.xyz;
            total.torque_a += push * torque_a;
            total.torque_b += push * torque_b;
        }
    }
    let mass = one.inverse_mass + other.inverse_mass;
    let q = mass * dot(total.force, total.force) + (turning(one, total.torque_a) + turning(other, total.torque_b));
    return sqrt(w * total.sums.y / max(q, LEAST_RESPONSE * mass * total.sums.x * total.sums.x));
}

// Least part of the response that forces without resistance to each other would have.
const LEAST_RESPONSE: f32 = 0.25;
