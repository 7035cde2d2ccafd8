// requires model/objects.wgsl model/order.wgsl model/step.wgsl

// Where two objects touch (physics.md section 2). A is the object that was added first, n points from A to B.

struct Touch {
    n: vec3f,
    // > 0: they touch.
    overlap: f32,
    // Parameter from end 1 to end 2 of A where A is a rod.
    a: f32,
    // The same of B.
    b: f32,
}

// The overlap of what has no contact line at all; where there is one, 0 is an overlap like others.
const NO_LINE: f32 = -3e38;

fn no_touch() -> Touch {
    return Touch(vec3f(0.0, 1.0, 0.0), NO_LINE, 0.0, 0.0);
}

// A distance that is so short beside the vectors it is the difference of is their rounding, and has no direction;
const ROUNDED: f32 = 5e-7;
// but where things are so small that rounding is more than this part of them, there is nothing else to go by.
const SMALL: f32 = 0.01;

// A distance vector of things that touch within a reach, 0 where it is but the rounding of vectors of this squared length: where it
// is nearly 0, what it is the difference of is no longer than the segments.
fn unrounded(distance: vec3f, squared: f32, reach: f32) -> vec3f {
    let rounded = min(ROUNDED * ROUNDED * squared, SMALL * SMALL * reach * reach);
    return select(distance, vec3f(0.0), dot(distance, distance) <= rounded);
}

// A vector without what it has along an axis of this squared length. The distance of a point from a line has nothing along it but
// what the rounding of the parameter adds, which would turn the normal of things that all but meet.
fn across(v: vec3f, axis: vec3f, squared: f32) -> vec3f {
    return v - dot(v, axis) / squared * axis;
}

// From the distance vector, which points from A to B, and the sum of the radii.
fn touch_at(distance: vec3f, reach: f32, a: f32, b: f32, normal_at_zero: vec3f) -> Touch {
    let squared = dot(distance, distance);
    if squared <= TINY {
        return Touch(normal_at_zero, reach, a, b);
    }
    let d = sqrt(squared);
    return Touch(distance / d, reach - d, a, b);
}

struct Axis {
    start: vec3f,
    along: vec3f,
    radius: f32,
}

// A rod: the spheres at its ends, and its axis.
struct Bar {
    ends: vec2u,
    axis: Axis,
}

fn bar_of(rod: u32) -> Bar {
    let ends = rod_ends(rod);
    let start = state[position_at(ends.x)].xyz;
    return Bar(ends, Axis(start, state[position_at(ends.y)].xyz - start, rod_radius(rod)));
}

struct Closest {
    hit: bool,
    a: f32,
    b: f32,
    // From A's point to B's.
    distance: vec3f,
    // The normal where the distance is 0.
    crossing: vec3f,
}

// A parameter that is less far beyond an end is at the end, which belongs to the segment: rounding must not decide.
const AT_END: f32 = 1e-6;

fn unit_interval(x: f32) -> bool {
    return abs(x - 0.5) <= 0.5 + AT_END;
}

// Closest points of two segments, (2.1) to (2.3). Parallel ones meet at the middle of the stretch they share.
fn closest_points(a_start: vec3f, a_along: vec3f, b_start: vec3f, b_along: vec3f, reach: f32) -> Closest {
    let aa = dot(a_along, a_along);
    let bb = dot(b_along, b_along);
    var closest = Closest(false, 0.0, 0.0, vec3f(0.0), vec3f(0.0, 1.0, 0.0));
    if (aa <= TINY) | (bb <= TINY) {
        return closest;
    }
    let between = b_start - a_start;
    let normal = cross(a_along, b_along);
    let nn = dot(normal, normal);
    let is_crossing = !(nn <= 1e-8 * aa * bb);
    if !is_crossing {
        let t0 = dot(between, a_along) / aa;
        let t1 = dot(between + b_along, a_along) / aa;
        let low = max(0.0, min(t0, t1));
        let high = min(1.0, max(t0, t1));
        closest.hit = low <= high + AT_END;
        closest.a = 0.5 * (low + high);
        closest.b = clamp(dot(closest.a * a_along - between, b_along) / bb, 0.0, 1.0);
    } else {
        closest.a = dot(between, cross(b_along, normal)) / nn;
        closest.b = dot(between, cross(a_along, normal)) / nn;
        closest.hit = unit_interval(closest.a) & unit_interval(closest.b);
        if !closest.hit {
            return closest;
        }
        closest.crossing = normal / sqrt(nn);
    }
    var distance = between + closest.b * b_along - closest.a * a_along;
    if is_crossing {
        // It is along the common normal: what else there is of it comes from the rounding of a and b.
        distance = dot(distance, closest.crossing) * closest.crossing;
    }
    closest.distance = unrounded(distance, aa + bb, reach);
    return closest;
}

fn touch_spheres(a: vec4f, b: vec4f) -> Touch {
    return touch_at(b.xyz - a.xyz, a.w + b.w, 0.0, 0.0, vec3f(0.0, 1.0, 0.0));
}

// To whom rods of fixed length join a sphere: they are one body and ignore each other. NONE, the other end of its capsule, or,
// where more rods end in it, SOME_RODS.
fn bonded_partner(sphere: u32) -> u32 {
    let end = end_of(sphere);
    if (end == NO_ROD) | (end == SOME_RODS) {
        return end;
    }
    return other_end(end, sphere);
}

// Whether a sphere of such partner is joined to another.
fn joined(a: u32, partner: u32, b: u32) -> bool {
    if partner != SOME_RODS {
        return partner == b;
    }
    let rods = rods_of(a);
    for (var k = 0u; k < rods.y; k++) {
        let rod = index_of(topology[rods.x + k]);
        if (rod_length(rod) > 0.0) & (other_end(rod, a) == b) {
            return true;
        }
    }
    return false;
}

fn touch_sphere_rod(sphere: u32, centre: vec4f, rod: Bar) -> Touch {
    if any(rod.ends == vec2u(sphere)) {
        return no_touch();
    }
    let axis = rod.axis;
    let squared = dot(axis.along, axis.along);
    let from_start = centre.xyz - axis.start;
    let b = dot(axis.along, from_start) / squared;
    if (squared <= TINY) | !unit_interval(b) {
        return no_touch();
    }
    let reach = centre.w + axis.radius;
    let apart = across(b * axis.along - from_start, axis.along, squared);
    let distance = unrounded(apart, squared, reach);
    return touch_at(distance, reach, 0.0, b, vec3f(0.0, 1.0, 0.0));
}

fn touch_rods(a: Bar, b: Bar) -> Touch {
    if any(a.ends == b.ends) | any(a.ends == b.ends.yx) {
        return no_touch();
    }
    let reach = a.axis.radius + b.axis.radius;
    let closest = closest_points(a.axis.start, a.axis.along, b.axis.start, b.axis.along, reach);
    if !closest.hit {
        return no_touch();
    }
    return touch_at(closest.distance, reach, closest.a, closest.b, closest.crossing);
}

fn squared_edges(box: Cuboid) -> vec3f {
    return vec3f(dot(box.i, box.i), dot(box.j, box.j), dot(box.k, box.k));
}

fn box_parameters(point: vec3f, box: Cuboid) -> vec3f {
    let from_corner = point - box.corner;
    let along = vec3f(dot(from_corner, box.i), dot(from_corner, box.j), dot(from_corner, box.k));
    return along / squared_edges(box);
}

fn in_unit_cube(t: vec3f) -> bool {
    return all(t >= vec3f(0.0)) & all(t <= vec3f(1.0));
}

// Whether a point, so far from an edge of a box, is in the box, or but for rounding on its surface.
fn in_box(point: vec3f, box: Cuboid, distance: f32) -> bool {
    let rounded = min(ROUNDED * length(point - box.corner), SMALL * distance) / sqrt(squared_edges(box));
    return all(abs(box_parameters(point, box) - 0.5) <= 0.5 + rounded);
}

// A centre inside the box leaves by the nearest face.
fn touch_sphere_box(centre: vec4f, box: Cuboid) -> Touch {
    let t = box_parameters(centre.xyz, box);
    let c = clamp(t, vec3f(0.0), vec3f(1.0));
    let edges = squared_edges(box);
    var apart = box.corner + c.x * box.i + c.y * box.j + c.z * box.k - centre.xyz;
    let beside = c == t;
    apart = select(apart, across(apart, box.i, edges.x), beside.x);
    apart = select(apart, across(apart, box.j, edges.y), beside.y);
    apart = select(apart, across(apart, box.k, edges.z), beside.z);
    let distance = unrounded(apart, max(edges.x, max(edges.y, edges.z)), centre.w);
    let squared = dot(distance, distance);
    if !(in_unit_cube(t) | (squared <= TINY)) {
        let d = sqrt(squared);
        return Touch(distance / d, centre.w - d, 0.0, 0.0);
    }
    let lengths = sqrt(edges);
    let low = c * lengths;
    let high = (vec3f(1.0) - c) * lengths;
    // Of faces equally far the first one counts.
    let nearer = 1.0 - AT_END;
    // n points into the box, against the way out.
    var depth = low.x;
    var n = box.i / lengths.x;
    if high.x < nearer * depth {
        depth = high.x;
        n = -box.i / lengths.x;
    }
    if low.y < nearer * depth {
        depth = low.y;
        n = box.j / lengths.y;
    }
    if high.y < nearer * depth {
        depth = high.y;
        n = -box.j / lengths.y;
    }
    if low.z < nearer * depth {
        depth = low.z;
        n = box.k / lengths.z;
    }
    if high.z < nearer * depth {
        depth = high.z;
        n = -box.k / lengths.z;
    }
    return Touch(n, centre.w + depth, 0.0, 0.0);
}

// A polygon is hit on the side of N = L x R only, and not at its edges.
fn touch_sphere_polygon(centre: vec4f, face: Polygon) -> Touch {
    let normal = cross(face.left, face.right);
    let nn = dot(normal, normal);
    let from_corner = centre.xyz - face.corner;
    let l = dot(cross(from_corner, face.right), normal) / nn;
    let k = dot(cross(face.left, from_corner), normal) / nn;
    let n_face = normal / sqrt(nn);
    let d = dot(from_corner, n_face);
    if unit_interval(l) & unit_interval(k) & (d >= 0.0) & (d < centre.w) {
        return Touch(-n_face, centre.w - d, 0.0, 0.0);
    }
    return no_touch();
}

// Edge g of a box: 0, 1, 2 for I, J, K, and round again.
fn box_edge(box: Cuboid, g: u32) -> vec3f {
    let turn = g % 3u;
    return select(select(box.k, box.j, turn == 1u), box.i, turn == 0u);
}

// What an edge or a vertex of a box does to a rod whose axis it comes near: it pushes it outward, also where the rod's
// axis point is inside the box already. Negative overlap: they are apart.
fn touch_box_feature(rod: Axis, box: Cuboid, a: f32, distance: vec3f, outward: vec3f) -> Touch {
    let squared = dot(distance, distance);
    if squared <= TINY {
        return Touch(-normalize(outward), rod.radius, a, 0.0);
    }
    let d = sqrt(squared);
    let n = distance / d;
    if (d < rod.radius) & in_box(rod.start + a * rod.along, box, d) {
        return Touch(-n, rod.radius + d, a, 0.0);
    }
    return Touch(n, rod.radius - d, a, 0.0);
}

fn touch_rod_edge(rod: Axis, box: Cuboid, feature: u32) -> Touch {
    let g = feature / 4u;
    let offset = vec2f(f32(feature & 1u), f32(feature >> 1u & 1u));
    let next = box_edge(box, g + 1u);
    let last = box_edge(box, g + 2u);
    let corner = box.corner + offset.x * next + offset.y * last;
    let closest = closest_points(rod.start, rod.along, corner, box_edge(box, g), rod.radius);
    if !closest.hit {
        return no_touch();
    }
    let side = 2.0 * offset - 1.0;
    let outward = side.x * normalize(next) + side.y * normalize(last);
    return touch_box_feature(rod, box, closest.a, closest.distance, outward);
}

fn touch_rod_vertex(rod: Axis, box: Cuboid, feature: u32) -> Touch {
    let offset = vec3f(f32(feature & 1u), f32(feature >> 1u & 1u), f32(feature >> 2u & 1u));
    let vertex = box.corner + offset.x * box.i + offset.y * box.j + offset.z * box.k;
    let squared = dot(rod.along, rod.along);
    let from_start = vertex - rod.start;
    let a = dot(rod.along, from_start) / squared;
    if (squared <= TINY) | !unit_interval(a) {
        return no_touch();
    }
    let side = 2.0 * offset - 1.0;
    let outward = side.x * normalize(box.i) + side.y * normalize(box.j) + side.z * normalize(box.k);
    let apart = across(from_start - a * rod.along, rod.along, squared);
    let distance = unrounded(apart, squared, rod.radius);
    return touch_box_feature(rod, box, a, distance, outward);
}

// Feature f is edge f; where no edge at all is hit, vertex f. The vertex is asked first: it is cheap, and where it is
// missed, as nearly always, the other edges do not matter.
fn touch_rod_box(rod: Axis, box: Cuboid, feature: u32) -> Touch {
    let edge = touch_rod_edge(rod, box, feature);
    if (edge.overlap > 0.0) | (feature >= 8u) {
        return edge;
    }
    let vertex = touch_rod_vertex(rod, box, feature);
    if vertex.overlap > 0.0 {
        for (var f = 0u; f < BOX_FEATURES; f++) {
            if touch_rod_edge(rod, box, f).overlap > 0.0 {
                return no_touch();
            }
        }
    }
    return vertex;
}

// Inverse mass of an object where it is touched: (2.6) for a rod, 0 for what cannot move.
fn inverse_mass_at(id: u32, at: f32) -> f32 {
    if id < step.spheres {
        return inverse_mass(id);
    }
    if id - step.spheres >= step.rods {
        return 0.0;
    }
    let ends = rod_ends(id - step.spheres);
    return (1.0 - at) * (1.0 - at) * inverse_mass(ends.x) + at * at * inverse_mass(ends.y);
}

// A rod, by its id and as it was read, and another object.
fn touch_bar(id: u32, own: Bar, other: u32, feature: u32) -> Touch {
    let boxes = step.spheres + step.rods;
    if other < step.spheres {
        return touch_sphere_rod(other, state[position_at(other)], own);
    }
    if other >= boxes {
        return touch_rod_box(own.axis, cuboid(other - boxes), feature);
    }
    let bar = bar_of(other - step.spheres);
    var a = own;
    var b = bar;
    if other < id {
        a = bar;
        b = own;
    }
    return touch_rods(a, b);
}

// A sphere, as it was read, and what is no sphere.
fn touch_static_or_rod(i: u32, id: u32, own: vec4f) -> Touch {
    let boxes = step.spheres + step.rods;
    if id < boxes {
        if RODS {
            return touch_sphere_rod(i, own, bar_of(id - step.spheres));
        }
        return no_touch();
    }
    if id < boxes + step.boxes {
        return touch_sphere_box(own, cuboid(id - boxes));
    }
    return touch_sphere_polygon(own, polygon(id - boxes - step.boxes));
}

// A sphere, as it was read, and another object.
fn touch_ball(id: u32, own: vec4f, other: u32) -> Touch {
    if other >= step.spheres {
        return touch_static_or_rod(id, other, own);
    }
    let ball = state[position_at(other)];
    let first = ordered(id, other).x == id;
    let found = touch_spheres(select(ball, own, first), select(own, ball, first));
    if found.overlap > 0.0 {
        if joined(id, bonded_partner(id), other) {
            return no_touch();
        }
    }
    return found;
}

// What is read of a mover once, and asked of it for every entry of its list: a sphere's position and radius, or a rod.
struct Own {
    id: u32,
    place: vec4f,
    bar: Bar,
}

fn own_of(mover: u32) -> Own {
    var own = Own(mover, vec4f(0.0), Bar(vec2u(NONE), Axis(vec3f(0.0), vec3f(0.0), 0.0)));
    if mover < step.spheres {
        own.place = state[position_at(mover)];
    } else if RODS {
        own.bar = bar_of(mover - step.spheres);
    }
    return own;
}

// A mover and any object that it may meet, whatever they weigh. Whoever asks gets the same bits.
fn touch_with(own: Own, id: u32, feature: u32) -> Touch {
    if own.id < step.spheres {
        return touch_ball(own.id, own.place, id);
    }
    if RODS {
        return touch_bar(own.id, own.bar, id, feature);
    }
    return no_touch();
}

// Any two objects that may meet, of which the first is a mover.
fn touch(a: u32, b: u32, feature: u32) -> Touch {
    return touch_with(own_of(a), b, feature);
}
