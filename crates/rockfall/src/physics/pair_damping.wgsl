// requires model/objects.wgsl model/order.wgsl model/step.wgsl physics/fine.wgsl physics/period.wgsl physics/rigid.wgsl physics/rigid_parts.wgsl

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

// Factor of the damping of the contact of spheres a and b with the overlap o, the normal n and the inverse mass w. Its spheres are no
// parts of boxes.
fn pair_damping(a: u32, b: u32, o: f32, n: vec3f, w: f32) -> f32 {
    let one = party_of(a);
    let other = party_of(b);
    let radii = vec2f(state[position_at(a)].w, state[position_at(b)].w);
    var total = Sums(vec2f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    for (var k = 0u; k < one.count; k++) {
        let i = member_of(one, k);
        let place = state[position_at(i)];
        let away = nearest_image(other.centre - place.xyz);
        let reach = other.reach + place.w;
        if (dot(away, away) > reach * reach) | (box_word(i) != 0u) {
            continue;
        }
        for (var l = 0u; l < other.count; l++) {
            let j = member_of(other, l);
            let far = state[position_at(j)];
            let d = between(i, j);
            let touching = place.w + far.w;
            if ((dot(d, d) > touching * touching) & ((i != a) | (j != b))) | (box_word(j) != 0u) {
                continue;
            }
            var overlap = touching - length(d);
            var normal = d / max(length(d), TINY);
            if (i == a) & (j == b) {
                overlap = o;
                normal = n;
            }
            if !(overlap > 0.0) {
                continue;
            }
            let lever_a = place.xyz - one.centre;
            let lever_b = far.xyz - other.centre;
            var kappa = 1.0;
            if LAW == LAW_THESIS {
                let mass = one.inverse_mass + turning(one, cross(lever_a, normal)) + (other.inverse_mass + turning(other, cross(lever_b, normal)));
                kappa = w / mass;
            } else if LAW == LAW_HERTZ_MINDLIN {
                let ratio = (place.w * far.w / (place.w + far.w)) / (radii.x * radii.y / (radii.x + radii.y));
                kappa = sqrt(ratio * overlap / o);
            }
            let push = kappa * overlap;
            total.sums += push * vec2f(1.0, overlap);
            total.force += push * normal;
            total.torque_a += push * cross(lever_a, normal);
            total.torque_b += push * cross(lever_b, normal);
        }
    }
    let mass = one.inverse_mass + other.inverse_mass;
    let q = mass * dot(total.force, total.force) + (turning(one, total.torque_a) + turning(other, total.torque_b));
    return sqrt(w * total.sums.y / max(q, LEAST_RESPONSE * mass * total.sums.x * total.sums.x));
}

// Least part of the response that forces without resistance to each other would have.
const LEAST_RESPONSE: f32 = 0.25;
