// requires laws/chosen.wgsl physics/pair_damping.wgsl model/order.wgsl model/step.wgsl physics/rigid_parts.wgsl

// Factor of the damping of a contact of a and b (docs/physics section 4.16), which damps as one with the other contacts of the same two
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
    if body_of_sphere(a) == NO_RIGID {
        return 1.0;
    }
    let body = party_of(a);
    var sums = vec2f(0.0);
    var moment = vec3f(0.0);
    for (var k = 0u; k < body.count; k++) {
        let lever = place_in(body, k);
        let radius = radius_of_member(body, k);
        let oj = o + (dot(lever - body.own_place, n) + (radius - body.radius));
        if !(oj > 0.0) {
            continue;
        }
        let kappa = law_stiffness_by_overlap(radius * oj / (body.radius * o));
        sums += kappa * oj * vec2f(1.0, oj);
        moment += kappa * oj * lever;
    }
    let q = body.inverse_mass * sums.x * sums.x + turning(body, cross(moment, n));
    return sqrt(w * sums.y / q);
}
