// requires model/objects.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/round_pair.wgsl physics/laws/history.wgsl physics/rigid.wgsl physics/rigid_parts.wgsl physics/smooth.wgsl physics/surface.wgsl

// What a contact of a law with history begins with in a step (docs/physics.md section 4.11).

// The overlap in the record of a contact with a polygon that a sphere passes from behind. It has no force.
const PASSAGE: f32 = -1.0;

// Whether the centre of a sphere was behind the plane of a polygon one step ago, unless it is a triangle, which has two sides. `velocity` is
// that of the sphere relative to the polygon.
fn comes_from_behind(own: vec4f, velocity: vec3f, id: u32, found: Touch) -> bool {
    if id < step.spheres + step.rods + step.boxes {
        return false;
    }
    let face = polygon(id - step.spheres - step.rods - step.boxes);
    if is_triangle(face) {
        return false;
    }
    if is_round(face) {
        return own.w - found.overlap + step.dt * dot(velocity, found.n) < 0.0;
    }
    return dot(near_shape(id, own.xyz) - face.corner - step.dt * velocity, normalize(cross(face.left, face.right))) < 0.0;
}

// The spring of a new contact of a sphere with a box or polygon: that of a box or polygon which it hides, or that of a passage, or
// otherwise `before`.
fn spring_on_surface(sphere: u32, id: u32, found: Touch, before: Spring) -> Spring {
    let own = state[position_at(sphere)];
    var chosen: Surfaces;
    choose_surface(candidate(id, own, found), &chosen);
    let objects = step.spheres + step.rods + step.boxes + step.polygons;
    var record = followed(first_record(sphere));
    while record != NONE {
        let other = key_of_record(record) >> FEATURE_BITS;
        let spring = spring_of_record(record);
        record = record_after(record);
        if is_static(other) & (other < objects) & (other != id) & (spring.overlap > 0.0) {
            if is_hidden(sphere, own, other, &chosen) {
                return spring;
            }
        }
    }
    let relative = state[velocity_at(sphere)].xyz - second_side(sphere, id, found).velocity;
    if comes_from_behind(own, relative, id, found) {
        return Spring(vec3f(0.0), PASSAGE, vec3f(0.0));
    }
    return before;
}

// Two spheres of a rigid body are neighbours if their centres are nearer than this part of the sum of their radii.
const NEIGHBOURS_WITHIN: f32 = 0.99;

// The longest displacement before the step of the contacts of neighbours of a and of b in their rigid bodies, each with the other object.
fn taken_shift(a: u32, b: u32, feature: u32) -> vec3f {
    var longest = vec3f(0.0);
    for (var side = 0u; side < 2u; side++) {
        let sphere = select(a, b, side == 1u);
        let other = select(b, a, side == 1u);
        if (sphere >= step.spheres) || (body_of_sphere(sphere) == NO_RIGID) || (box_word(sphere) != 0u) {
            continue;
        }
        let record = rigid_record(body_of_sphere(sphere));
        let places = topology[record + 11u] + SHAPE_WORDS;
        let members = topology[record + 12u];
        let count = topology[record + 13u];
        let own = member_number(record, sphere);
        for (var k = 0u; k < count; k++) {
            let apart = vector_at(places + 3u * k) - vector_at(places + 3u * own);
            let most = NEIGHBOURS_WITHIN * (float_at(members + count + k) + float_at(members + count + own));
            let neighbour = id_of(topology[members + k]);
            if (k == own) || (dot(apart, apart) >= most * most) || (box_word(neighbour) != 0u) {
                continue;
            }
            let pair = ordered(neighbour, other);
            let spring = spring_of(pair.x, pair.y, feature);
            if (spring.overlap > 0.0) & (dot(spring.shift, spring.shift) > dot(longest, longest)) {
                longest = select(spring.shift, -spring.shift, (pair.x == other) != (side == 1u));
            }
        }
    }
    return longest;
}

// The spring before the step of the contact of a and b, of which a was added first.
fn spring_before(a: u32, b: u32, feature: u32, found: Touch) -> Spring {
    var spring = spring_of(a, b, feature);
    if spring.overlap != 0.0 {
        return spring;
    }
    if (a < step.spheres) & is_static(b) & (found.overlap > 0.0) {
        // A corner that a solid touches keeps its place on the wall.
        if !RIGID_BODIES || !is_solid(box_word(a)) {
            spring = spring_on_surface(a, b, found, spring);
        }
    }
    if RIGID_BODIES {
        if spring.overlap == 0.0 {
            let taken = taken_shift(a, b, feature);
            spring.shift = select(spring.shift, taken, any(taken != vec3f(0.0)));
        }
    }
    return spring;
}
