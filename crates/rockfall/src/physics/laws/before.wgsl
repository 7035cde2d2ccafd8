// requires model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/round_pair.wgsl
// requires physics/laws/history.wgsl physics/laws/shared.wgsl physics/smooth.wgsl physics/surface.wgsl

// What a contact of a law with history begins with in a step (docs/physics section 4.11).

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

// The spring of a contact of a sphere with a box or polygon that has none of its own: that of a box or polygon which it hides.
fn spring_on_surface(sphere: u32, id: u32, found: Touch) -> Spring {
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
    return Spring(vec3f(0.0), select(0.0, PASSAGE, comes_from_behind(own, relative, id, found)), vec3f(0.0));
}

// What a contact begins a step with.
struct Before {
    spring: Spring,
    share: SpringShare,
}

// The spring before the step of the contact of a and b, of which a was added first, and its share in that of neighbours.
fn spring_before(a: u32, b: u32, feature: u32, found: Touch) -> Before {
    var before = Before(spring_of(a, b, feature), SpringShare(1.0, 1.0, false));
    let is_ball = (a < step.spheres) & is_static(b) & (found.overlap > 0.0);
    let is_new = before.spring.overlap == 0.0;
    if is_new & is_ball {
        before.spring = spring_on_surface(a, b, found);
    }
    if RIGID_BODIES {
        if before.spring.overlap >= 0.0 {
            var fed = before.spring;
            before.share = share_in_group(a, b, feature, found.overlap, &fed);
            if !(is_new & (before.spring.overlap > 0.0)) {
                before.spring = fed;
            }
        }
    }
    return before;
}
