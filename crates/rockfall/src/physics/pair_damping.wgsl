// requires model/objects.wgsl model/order.wgsl model/step.wgsl physics/fine.wgsl physics/period.wgsl physics/rigid.wgsl physics/rigid_box.wgsl
// requires physics/rigid_parts.wgsl physics/round_pair.wgsl

// Damping of the contacts of the spheres of two bodies, at least one of which is a rigid body (docs/physics.md section 4.16).

// A rigid body, or a sphere of its own.
struct Party {
    // First word of the record of a rigid body, or NONE.
    record: u32,
    // The sphere of its own.
    sphere: u32,
    count: u32,
    inverse_mass: f32,
    centre: vec3f,
    // Greatest distance of a point of a sphere from the centre.
    reach: f32,
}

fn party_of(sphere: u32) -> Party {
    let body = body_of_sphere(sphere);
    if body == NO_RIGID {
        let place = state[position_at(sphere)];
        return Party(NONE, sphere, 1u, inverse_mass(sphere), place.xyz, place.w);
    }
    let record = rigid_record(body);
    return Party(record, sphere, topology[record + 13u], float_at(record + 3u), vector_at(record), float_at(record + 18u));
}

fn member_of(party: Party, k: u32) -> u32 {
    if party.record == NONE {
        return party.sphere;
    }
    return id_of(topology[topology[party.record + 12u] + k]);
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

// A contact of two spheres of two parties.
struct Meeting {
    overlap: f32,
    // From the first party to the second one.
    normal: vec3f,
    // From the centre of each party to a point of the line along the normal.
    lever_a: vec3f,
    lever_b: vec3f,
}

// The radius of a sphere; of the solid of a box, its rounding radius.
fn round_radius(sphere: u32, place: vec4f) -> f32 {
    let word = box_word(sphere);
    if is_solid(word) {
        return float_at(word + 3u);
    }
    return place.w;
}

// Whether spheres at these places are too far apart to touch. With double precision the places are rounded.
fn are_apart(place: vec4f, far: vec4f) -> bool {
    let d = nearest_image(far.xyz - place.xyz);
    var touching = place.w + far.w;
    if DOUBLE {
        touching += LOW_PARTS * max(largest_coordinate(place), largest_coordinate(far));
    }
    return dot(d, d) > SLACK * touching * touching;
}

// The contact of spheres i and j, which are at `place` and `far`. The overlap is 0 or less without one.
fn meeting_of(one: Party, other: Party, i: u32, j: u32, place: vec4f, far: vec4f) -> Meeting {
    let levers = Meeting(0.0, vec3f(0.0), place.xyz - one.centre, far.xyz - other.centre);
    if step.rigid_parts_at != 0u {
        let words = vec2u(box_word(i), box_word(j));
        if (words.x | words.y) != 0u {
            if is_left_to_others(i, j) {
                return levers;
            }
            let found = touch_solid(i, j, words.x, words.y);
            var met = Meeting(found.overlap, found.n, levers.lever_a, levers.lever_b);
            if is_solid(words.x) {
                met.lever_a += between(i, j);
            } else {
                met.lever_b += between(j, i);
            }
            return met;
        }
    }
    let d = between(i, j);
    let distance = length(d);
    return Meeting(place.w + far.w - distance, d / max(distance, TINY), levers.lever_a, levers.lever_b);
}

// Factor of the damping of the contact of spheres a and b with the overlap o, the normal n and the inverse mass w.
fn pair_damping(a: u32, b: u32, o: f32, n: vec3f, w: f32) -> f32 {
    let one = party_of(a);
    let other = party_of(b);
    let radii = vec2f(round_radius(a, state[position_at(a)]), round_radius(b, state[position_at(b)]));
    var total = Sums(vec2f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    for (var k = 0u; k < one.count; k++) {
        let i = member_of(one, k);
        let place = state[position_at(i)];
        if are_apart(place, vec4f(other.centre, other.reach)) {
            continue;
        }
        for (var l = 0u; l < other.count; l++) {
            let j = member_of(other, l);
            let far = state[position_at(j)];
            let is_own = (i == a) & (j == b);
            if are_apart(place, far) & !is_own {
                continue;
            }
            var met = meeting_of(one, other, i, j, place, far);
            if is_own {
                met.overlap = o;
                met.normal = n;
            }
            if !(met.overlap > 0.0) {
                continue;
            }
            let torque_a = cross(met.lever_a, met.normal);
            let torque_b = cross(met.lever_b, met.normal);
            var kappa = 1.0;
            if LAW == LAW_THESIS {
                let mass = one.inverse_mass + turning(one, torque_a) + (other.inverse_mass + turning(other, torque_b));
                kappa = w / mass;
            } else if LAW == LAW_HERTZ_MINDLIN {
                let round = vec2f(round_radius(i, place), round_radius(j, far));
                let ratio = (round.x * round.y / (round.x + round.y)) / (radii.x * radii.y / (radii.x + radii.y));
                kappa = sqrt(ratio * met.overlap / o);
            }
            let push = kappa * met.overlap;
            total.sums += push * vec2f(1.0, met.overlap);
            total.force += push * met.normal;
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
