// requires physics/pair_damping.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/rigid.wgsl physics/rigid_parts.wgsl

// A vector times the inverse inertia times itself.
fn spun(record: u32, v: vec3f) -> f32 {
    return dot(v, by_inverse_inertia(record, v));
}

// Factor of the damping of a contact of a and b (docs/physics.md section 4.16), which damps as one with the other contacts of the same two
// bodies. `w` holds the inverse masses of a and b.
fn shared_damping(a: u32, b: u32, o: f32, n: vec3f, w: vec2f) -> f32 {
    if !RIGID_BODIES {
        return 1.0;
    }
    if (a >= step.spheres) | !(o > 0.0) {
        return 1.0;
    }
    if b >= step.spheres + step.rods {
        return wall_damping(a, o, n, w.x);
    }
    if b >= step.spheres {
        return 1.0;
    }
    if (body_of_sphere(a) == NO_RIGID) & (body_of_sphere(b) == NO_RIGID) {
        return 1.0;
    }
    // Both threads of the pair add in the same order.
    let is_first = ordered(a, b).x == a;
    return pair_damping(select(b, a, is_first), select(a, b, is_first), o, select(-n, n, is_first), w.x + w.y);
}

// The same for a sphere and a wall, which is taken as a plane. `w` is the inverse mass of the sphere.
fn wall_damping(a: u32, o: f32, n: vec3f, w: f32) -> f32 {
    let body = body_of_sphere(a);
    if (body == NO_RIGID) || is_solid(box_word(a)) {
        return 1.0;
    }
    let record = rigid_record(body);
    let centre = vector_at(record);
    let members = topology[record + 12u];
    let own = state[position_at(a)];
    var sums = vec2f(0.0);
    var moment = vec3f(0.0);
    for (var k = 0u; k < topology[record + 13u]; k++) {
        let j = id_of(topology[members + k]);
        let place = state[position_at(j)];
        let oj = o + (dot(place.xyz - own.xyz, n) + (place.w - own.w));
        if !(oj > 0.0) || is_solid(box_word(j)) {
            continue;
        }
        let lever = place.xyz - centre;
        var kappa = 1.0;
        if LAW == LAW_THESIS {
            kappa = w / (float_at(record + 3u) + spun(record, cross(lever, n)));
        } else if LAW == LAW_HERTZ_MINDLIN {
            kappa = sqrt(place.w * oj / (own.w * o));
        }
        sums += kappa * oj * vec2f(1.0, oj);
        moment += kappa * oj * lever;
    }
    let q = float_at(record + 3u) * sums.x * sums.x + spun(record, cross(moment, n));
    return sqrt(w * sums.y / q);
}
