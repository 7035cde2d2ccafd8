// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl physics/round_pair.wgsl physics/smooth.wgsl physics/walls.wgsl

// Contacts that began and ended within the last step, called crossings (docs/physics section 3.10). The motion of the step is
// taken as straight. Times are in s before the present.

// Overlaps up to this fraction of the smaller radius are rounding errors.
const CROSSING_ROUNDING: f32 = 1e-5;
// Most iterations for the first contact with a box or polygon, and how far from it, in radii, the last one may end.
const CROSSING_ROUNDS: u32 = 16u;
const CROSSING_REACH: f32 = 1e-3;
// In place of a time, where objects do not cross.
const NO_CROSSING: f32 = -1.0;

// Velocity at which a sphere itself moves. That of a fixed sphere belongs to its surface.
fn path_of(sphere: u32) -> vec3f {
    let velocity = state[velocity_at(sphere)];
    return select(vec3f(0.0), velocity.xyz, velocity.w > 0.0);
}

// Velocity of a wall at the centre of a sphere: the path of the sphere is taken relative to it.
fn drift_of(sphere: u32, wall: u32) -> vec3f {
    if WALLS {
        if wall >= step.spheres + step.rods {
            return velocity_of_wall(wall_of(wall), state[position_at(sphere)].xyz);
        }
    }
    return vec3f(0.0);
}

fn crossing_of_spheres(a: u32, b: u32) -> f32 {
    let one = state[position_at(a)];
    let two = state[position_at(b)];
    let d = between(a, b);
    let p = path_of(b) - path_of(a);
    let pp = dot(p, p);
    if !(pp > 0.0) {
        return NO_CROSSING;
    }
    let middle = dot(d, p) / pp;
    if !finite(vec3f(pp, middle, 0.0)) {
        return NO_CROSSING;
    }
    let reach = one.w + two.w;
    let nearest = d - middle * p;
    let chord = reach * reach - dot(nearest, nearest);
    let overlap_before = reach - length(d - step.dt * p);
    if (middle >= step.dt) | (chord <= 0.0) | (overlap_before > CROSSING_ROUNDING * min(one.w, two.w)) {
        return NO_CROSSING;
    }
    let time = min(step.dt, middle + sqrt(chord / pp));
    return select(NO_CROSSING, time, time > 0.0);
}

// The contact of a sphere with a box or polygon.
fn contact_with_shape(place: vec4f, id: u32) -> Touch {
    let boxes = step.spheres + step.rods;
    let centre = vec4f(near_shape(id, place.xyz), place.w);
    if id < boxes + step.boxes {
        return touch_sphere_box(centre, cuboid(id - boxes));
    }
    return touch_sphere_polygon(centre, polygon(id - boxes - step.boxes));
}

// Whether an object is a cone or a ball that is touched from inside.
fn is_hollow(id: u32) -> bool {
    let polygons = step.spheres + step.rods + step.boxes;
    if !SMOOTH | (id < polygons) {
        return false;
    }
    let face = polygon(id - polygons);
    return is_round(face) && (side_of_round(face) < 0.0);
}

// The time up to which a sphere was apart from a cone or ball around it, from which the distance is a concave function of the time. The first two
// rounds are the start and the end of the step. NO_CROSSING unless it was apart at the start alone.
fn crossing_of_hollow(sphere: u32, velocity: vec3f, id: u32) -> f32 {
    let centre = state[position_at(sphere)];
    var past = 0.0;
    var apart = step.dt;
    for (var round = 0u; round < CROSSING_ROUNDS + 2u; round++) {
        var time = 0.5 * (past + apart);
        if round < 2u {
            time = select(0.0, step.dt, round == 0u);
        }
        let found = contact_with_shape(vec4f(centre.xyz - time * velocity, centre.w), id);
        let is_past = (found.overlap == NO_CONTACT_LINE) | (found.overlap > CROSSING_ROUNDING * centre.w);
        if (round < 2u) & (is_past != (round == 1u)) {
            return NO_CROSSING;
        }
        past = select(past, time, is_past);
        apart = select(time, apart, is_past);
    }
    return apart;
}

// The distance of a sphere from a box or polygon is a convex function of the time.
fn crossing_of_shape(sphere: u32, velocity: vec3f, id: u32) -> f32 {
    let centre = state[position_at(sphere)];
    var time = step.dt;
    var first = 0u;
    if is_hollow(id) {
        let halved = crossing_of_hollow(sphere, velocity, id);
        time = select(time, halved, halved >= 0.0);
        first = select(0u, CROSSING_ROUNDS, halved >= 0.0);
    }
    var found = no_touch();
    // The first contact is looked for in one loop so that compilers make one copy of the contact.
    for (var round = first; round <= CROSSING_ROUNDS; round++) {
        found = contact_with_shape(vec4f(centre.xyz - time * velocity, centre.w), id);
        let is_pressed = (round == 0u) & (found.overlap > CROSSING_ROUNDING * centre.w);
        if (found.overlap == NO_CONTACT_LINE) | is_pressed {
            return NO_CROSSING;
        }
        let closing = dot(velocity, found.n);
        if (found.overlap >= 0.0) | (closing <= 0.0) | (round == CROSSING_ROUNDS) {
            break;
        }
        time += found.overlap / closing;
    }
    let is_hit = (found.overlap >= -CROSSING_REACH * centre.w) & (dot(velocity, found.n) > 0.0) & (time > 0.0);
    return select(NO_CROSSING, time, is_hit);
}

// The time of the first contact of two objects, a before b in insertion order, or NO_CROSSING. a is a sphere.
fn time_of_crossing(a: u32, b: u32) -> f32 {
    if b < step.spheres {
        return crossing_of_spheres(a, b);
    }
    return crossing_of_shape(a, path_of(a) - drift_of(a, b), b);
}

// A contact as it was at an earlier time, with the present velocities.
struct ContactBefore {
    n: vec3f,
    overlap: f32,
    approach: f32,
}

fn contact_before(a: u32, b: u32, time: f32) -> ContactBefore {
    let own = state[position_at(a)];
    let centre = vec4f(own.xyz - time * (path_of(a) - drift_of(a, b)), own.w);
    var approach = state[velocity_at(a)].xyz;
    var found = no_touch();
    let boxes = step.spheres + step.rods;
    if b < step.spheres {
        let their = state[position_at(b)];
        var place = their.xyz;
        if PERIODIC {
            place = own.xyz + nearest_image(place - own.xyz);
        }
        found = touch_spheres(centre, vec4f(place - time * path_of(b), their.w));
        approach -= state[velocity_at(b)].xyz;
    } else {
        found = contact_with_shape(centre, b);
    }
    if WALLS {
        if b >= boxes {
            approach -= velocity_of_wall(wall_of(b), centre.xyz + (centre.w - found.overlap) * found.n);
        }
    }
    return ContactBefore(found.n, found.overlap, dot(approach, found.n));
}

// Whether an object is a sphere in which no rod ends.
fn is_free_sphere(id: u32) -> bool {
    if id >= step.spheres {
        return false;
    }
    if !RODS {
        return true;
    }
    return end_of(id) == NO_ROD;
}

// The time at which two objects, a before b in insertion order, began to touch within the step, if they then approached faster
// than `threshold`; else NO_CROSSING. They may touch still.
fn time_of_beginning(a: u32, b: u32, threshold: f32) -> f32 {
    if !is_free_sphere(a) | ((b >= step.spheres) & (b < step.spheres + step.rods)) {
        return NO_CROSSING;
    }
    var inverse_masses = inverse_mass(a);
    if b < step.spheres {
        if !is_free_sphere(b) {
            return NO_CROSSING;
        }
        inverse_masses += inverse_mass(b);
    }
    let time = time_of_crossing(a, b);
    if (time < 0.0) | (inverse_masses <= 0.0) {
        return NO_CROSSING;
    }
    return select(NO_CROSSING, time, contact_before(a, b, time).approach > threshold);
}

// Whether two objects move apart along n. The motion of the surface of a fixed sphere does not count.
fn separates(a: u32, b: u32, n: vec3f) -> bool {
    var velocity = drift_of(a, b) - path_of(a);
    if b < step.spheres {
        velocity += path_of(b);
    }
    return dot(velocity, n) > 0.0;
}

// The time of the crossing of two objects that collides, or NO_CROSSING. `radius` is the smaller one of the pair.
fn time_of_colliding_crossing(a: u32, b: u32, radius: f32, threshold: f32) -> f32 {
    let time = time_of_beginning(a, b, threshold);
    if time < 0.0 {
        return time;
    }
    let now = contact_before(a, b, 0.0);
    // The sphere is behind a polygon, which it has passed.
    if now.overlap == NO_CONTACT_LINE {
        return time;
    }
    // A pressed contact that approaches fast collides as it is. One that is not pressed, and does not separate, has just begun.
    if now.overlap > CROSSING_ROUNDING * radius {
        return select(time, NO_CROSSING, now.approach > threshold);
    }
    return select(NO_CROSSING, time, separates(a, b, now.n));
}
