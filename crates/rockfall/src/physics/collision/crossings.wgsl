// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl physics/walls.wgsl

// Contacts that began and ended within the last step, called crossings (docs/physics.md section 3.10). The motion of the step is
// taken as straight. Times are in s before the present.

// Overlaps up to this fraction of the smaller radius are rounding errors.
const CROSSING_ROUNDING: f32 = 1e-5;
// Most iterations for the first contact with a box, and how far from it, in radii, the last one may end.
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
    let d = two.xyz - one.xyz;
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

// The contact of a box with a sphere that moves at a velocity, at an earlier time: the overlap, and the approach velocity.
fn box_contact_before(centre: vec4f, velocity: vec3f, box: Cuboid, time: f32) -> vec2f {
    let found = touch_sphere_box(vec4f(centre.xyz - time * velocity, centre.w), box);
    return vec2f(found.overlap, dot(velocity, found.n));
}

fn crossing_of_box(sphere: u32, velocity: vec3f, box: Cuboid) -> f32 {
    let centre = state[position_at(sphere)];
    var at = box_contact_before(centre, velocity, box, step.dt);
    if at.x > CROSSING_ROUNDING * centre.w {
        return NO_CROSSING;
    }
    var time = step.dt;
    for (var round = 0u; round < CROSSING_ROUNDS; round++) {
        if (at.x >= 0.0) | (at.y <= 0.0) {
            break;
        }
        time += at.x / at.y;
        at = box_contact_before(centre, velocity, box, time);
    }
    let is_hit = (at.x >= -CROSSING_REACH * centre.w) & (at.y > 0.0) & (time > 0.0);
    return select(NO_CROSSING, time, is_hit);
}

// The times at which a coordinate that is now `place` and changes at `rate` lies between two bounds: from x to y.
fn times_within(place: f32, rate: f32, low: f32, high: f32) -> vec2f {
    if rate == 0.0 {
        return select(vec2f(3e38, -3e38), vec2f(-3e38, 3e38), (place >= low) & (place <= high));
    }
    let one = (place - low) / rate;
    let two = (place - high) / rate;
    return vec2f(min(one, two), max(one, two));
}

fn crossing_of_polygon(sphere: u32, velocity: vec3f, polygon: Polygon) -> f32 {
    let face = face_of(polygon);
    let centre = state[position_at(sphere)];
    let from_corner = centre.xyz - polygon.corner;
    let height = dot(from_corner, face.n);
    let rise = dot(velocity, face.n);
    if !(rise < 0.0) {
        return NO_CROSSING;
    }
    let place = along_edges(face, from_corner);
    let rate = along_edges(face, velocity);
    let near = times_within(height, rise, 0.0, (1.0 - CROSSING_ROUNDING) * centre.w);
    let across_l = times_within(place.x, rate.x, -AT_END, 1.0 + AT_END);
    let across_k = times_within(place.y, rate.y, -AT_END, 1.0 + AT_END);
    let last = max(near.x, max(across_l.x, across_k.x));
    let first = min(near.y, min(across_l.y, across_k.y));
    if (last <= 0.0) | (first >= step.dt) | (last >= first) {
        return NO_CROSSING;
    }
    return clamp((height - centre.w) / rise, 0.0, step.dt);
}

// The time of the first contact of two objects, a before b in insertion order, or NO_CROSSING. a is a sphere.
fn time_of_crossing(a: u32, b: u32) -> f32 {
    if b < step.spheres {
        return crossing_of_spheres(a, b);
    }
    let boxes = step.spheres + step.rods;
    if b < boxes + step.boxes {
        return crossing_of_box(a, path_of(a) - drift_of(a, b), cuboid(b - boxes));
    }
    return crossing_of_polygon(a, path_of(a) - drift_of(a, b), polygon(b - boxes - step.boxes));
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
        found = touch_spheres(centre, vec4f(their.xyz - time * path_of(b), their.w));
        approach -= state[velocity_at(b)].xyz;
    } else if b < boxes + step.boxes {
        found = touch_sphere_box(centre, cuboid(b - boxes));
    } else {
        // The plane of a polygon, also beside and behind it.
        let wall = polygon(b - boxes - step.boxes);
        let n = face_of(wall).n;
        found = Touch(-n, centre.w - dot(centre.xyz - wall.corner, n), 0.0, 0.0);
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
    // A crossing of a polygon is known to be over.
    if (time < 0.0) | (b >= step.spheres + step.rods + step.boxes) {
        return time;
    }
    let now = contact_before(a, b, 0.0);
    // A pressed contact that approaches fast collides as it is. One that is not pressed, and does not separate, has just begun.
    if now.overlap > CROSSING_ROUNDING * radius {
        return select(time, NO_CROSSING, now.approach > threshold);
    }
    return select(NO_CROSSING, time, separates(a, b, now.n));
}
