// requires model/objects.wgsl model/order.wgsl model/step.wgsl physics/fine.wgsl physics/scale.wgsl physics/smooth.wgsl physics/rod_polygon.wgsl physics/round_pair.wgsl

// Where two objects touch (docs/physics section 2). A is the object that was added first. n points from A to B.

// A rod: the ids of its end spheres, and its axis as seen from a sphere (see `place_from`): end 1 unless another one is named.
struct Bar {
    ends: vec2u,
    axis: Axis,
}

fn bar_of(rod: u32) -> Bar {
    let ends = rod_ends(rod);
    return bar_from(rod, ends.x);
}

// A rod as seen from a sphere.
fn bar_from(rod: u32, origin: u32) -> Bar {
    let ends = rod_ends(rod);
    return Bar(ends, Axis(place_from(origin, ends.x), between(ends.x, ends.y), rod_radius(rod)));
}

// With double precision, places are seen from a sphere of the pair of objects, because differences of positions keep their digits.
// Otherwise the origin is that of the scene. Two functions that compare the same objects must choose the same sphere.

fn place_from(origin: u32, sphere: u32) -> vec3f {
    if DOUBLE {
        return fine_between(origin, sphere).high;
    }
    return state[position_at(sphere)].xyz;
}

// From the corner of a box or polygon to its middle, from which the nearest image counts. Triangles have that of their parallelogram.
fn middle_of_box(box: Cuboid) -> vec3f {
    return 0.5 * (box.i + box.j + box.k);
}

fn middle_of_polygon(face: Polygon) -> vec3f {
    if is_plane(face) || is_round(face) {
        return middle_of_smooth(face);
    }
    return 0.5 * (face.left + face.right);
}

// The image of a place that is nearest to the middle of a box or polygon.
fn near_shape(id: u32, place: vec3f) -> vec3f {
    if !PERIODIC {
        return place;
    }
    let boxes = step.spheres + step.rods;
    var middle = vec3f(0.0);
    if id < boxes + step.boxes {
        let box = cuboid(id - boxes);
        middle = box.corner + middle_of_box(box);
    } else {
        let face = polygon(id - boxes - step.boxes);
        middle = face.corner + middle_of_polygon(face);
    }
    return middle + nearest_image(place - middle);
}

fn box_from(origin: u32, box: Cuboid) -> Cuboid {
    if DOUBLE {
        return Cuboid(-fine_from_corner(box.corner, middle_of_box(box), origin).high, box.i, box.j, box.k);
    }
    return box;
}

fn polygon_from(origin: u32, face: Polygon) -> Polygon {
    if DOUBLE {
        let corner = -fine_from_corner(face.corner, middle_of_polygon(face), origin).high;
        return Polygon(corner, face.left, face.right, face.surface);
    }
    return face;
}

struct Closest {
    hit: bool,
    a: f32,
    b: f32,
    // From A's point to B's.
    distance: vec3f,
    // Normal to use where the distance is 0.
    crossing: vec3f,
}

// Closest points of two segments, (2.1) to (2.3). For parallel segments, the middle of the interval in which they lie side by
// side.
fn closest_points(a_start: vec3f, a_along: vec3f, b_start: vec3f, b_along: vec3f, reach: f32) -> Closest {
    let aa = dot(a_along, a_along);
    let bb = dot(b_along, b_along);
    var closest = Closest(false, 0.0, 0.0, vec3f(0.0), vec3f(0.0, 1.0, 0.0));
    if (aa <= TINY) | (bb <= TINY) {
        return closest;
    }
    let between = b_start - a_start;
    let a_scale = scale_of(a_along);
    let b_scale = scale_of(b_along);
    let a_scaled = a_scale * a_along;
    let b_scaled = b_scale * b_along;
    let normal = cross(a_scaled, b_scaled);
    let nn = dot(normal, normal);
    let is_crossing = !(nn <= 1e-8 * dot(a_scaled, a_scaled) * dot(b_scaled, b_scaled));
    if !is_crossing {
        let t0 = dot(between, a_along) / aa;
        let t1 = dot(between + b_along, a_along) / aa;
        let low = max(0.0, min(t0, t1));
        let high = min(1.0, max(t0, t1));
        closest.hit = low <= high + AT_END;
        closest.a = 0.5 * (low + high);
        closest.b = clamp(dot(closest.a * a_along - between, b_along) / bb, 0.0, 1.0);
    } else {
        let places = vec2f(dot(between, cross(b_scaled, normal)), dot(between, cross(a_scaled, normal))) / nn;
        closest.a = a_scale * places.x;
        closest.b = b_scale * places.y;
        closest.hit = unit_interval(closest.a) & unit_interval(closest.b);
        if !closest.hit {
            return closest;
        }
        closest.crossing = normal / sqrt(nn);
    }
    var distance = between + closest.b * b_along - closest.a * a_along;
    if is_crossing {
        // The distance is along the common normal. Its other components are rounding errors of a and b.
        distance = dot(distance, closest.crossing) * closest.crossing;
    }
    closest.distance = unrounded(distance, aa + bb, reach);
    return closest;
}

fn touch_spheres(a: vec4f, b: vec4f) -> Touch {
    return touch_at(b.xyz - a.xyz, a.w + b.w, 0.0, 0.0, vec3f(0.0, 1.0, 0.0));
}

// The same for positions with a low part. The overlap is a small difference of two lengths, so their last digits count.
fn touch_spheres_finely(distance: Fine, own: f32, other: f32) -> Touch {
    let reach = sum_of(vec3f(own), vec3f(other));
    var found = touch_at(distance.high, reach.high.x, 0.0, 0.0, vec3f(0.0, 1.0, 0.0));
    let d = length(distance.high);
    if d * d > TINY {
        found.overlap = (reach.high.x - d) + (reach.low.x - length_beyond(distance, d));
    }
    return found;
}

// The sphere that a rod of fixed length connects to this sphere. Such a pair never interacts. NONE when no rod ends in the
// sphere, SOME_RODS when several rods or a rod of free length do.
fn bonded_partner(sphere: u32) -> u32 {
    let end = end_of(sphere);
    if (end == NO_ROD) | (end == SOME_RODS) {
        return end;
    }
    return other_end(end, sphere);
}

// Whether a rod of fixed length connects spheres a and b. `partner` is the `bonded_partner` of a.
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

// Whether a point is in a box or on its surface, up to rounding errors (docs/physics section 2.9). `distance` is its
// distance from an edge or vertex of the box.
fn in_box(point: vec3f, box: Cuboid, distance: f32) -> bool {
    let rounded = min(ROUNDED * length(point - box.corner), SMALL * distance) / sqrt(squared_edges(box));
    return all(abs(box_parameters(point, box) - 0.5) <= 0.5 + rounded);
}

// A sphere with its centre inside the box leaves through the nearest face.
fn touch_sphere_box(centre: vec4f, box: Cuboid) -> Touch {
    let t = box_parameters(centre.xyz, box);
    let c = clamp(t, vec3f(0.0), vec3f(1.0));
    return touch_box_at(centre.w, box, t, box.corner + c.x * box.i + c.y * box.j + c.z * box.k - centre.xyz);
}

// The same for a position with a low part.
fn touch_box_finely(i: u32, radius: f32, box: Cuboid) -> Touch {
    let from_corner = fine_from_corner(box.corner, middle_of_box(box), i);
    let far = from_corner.high;
    let t = vec3f(dot(far, box.i), dot(far, box.j), dot(far, box.k)) / squared_edges(box);
    let c = clamp(t, vec3f(0.0), vec3f(1.0));
    var apart = Fine(-far, -from_corner.low);
    apart = fine_sum(apart, product_of(vec3f(c.x), box.i));
    apart = fine_sum(apart, product_of(vec3f(c.y), box.j));
    apart = fine_sum(apart, product_of(vec3f(c.z), box.k));
    var found = touch_box_at(radius, box, t, apart.high);
    if found.overlap < radius {
        found.overlap -= dot(apart.low, found.n);
    }
    return found;
}

// Contact of a sphere with a box. `t` are the parameters of its centre, and `to_box` points from the centre to the nearest point of the
// box.
fn touch_box_at(radius: f32, box: Cuboid, t: vec3f, to_box: vec3f) -> Touch {
    let c = clamp(t, vec3f(0.0), vec3f(1.0));
    let edges = squared_edges(box);
    var apart = to_box;
    let beside = c == t;
    apart = select(apart, across(apart, box.i, edges.x), beside.x);
    apart = select(apart, across(apart, box.j, edges.y), beside.y);
    apart = select(apart, across(apart, box.k, edges.z), beside.z);
    let distance = unrounded(apart, max(edges.x, max(edges.y, edges.z)), radius);
    let squared = dot(distance, distance);
    if !(in_unit_cube(t) | (squared <= TINY)) {
        let d = sqrt(squared);
        return Touch(distance / d, radius - d, 0.0, 0.0);
    }
    let lengths = sqrt(edges);
    let low = c * lengths;
    let high = (vec3f(1.0) - c) * lengths;
    // A later face must be nearer by this factor to replace an earlier one.
    let nearer = 1.0 - AT_END;
    // n points from the nearest face into the box.
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
    return Touch(n, radius + depth, 0.0, 0.0);
}

// The face of a polygon, with scaled edges.
struct Face {
    left: vec3f,
    right: vec3f,
    scales: vec2f,
    // L x R of the scaled edges, and its square.
    across: vec3f,
    squared: f32,
    // Unit normal.
    n: vec3f,
}

fn face_of(polygon: Polygon) -> Face {
    let scales = vec2f(scale_of(polygon.left), scale_of(polygon.right));
    let left = scales.x * polygon.left;
    let right = scales.y * polygon.right;
    let normal = cross(left, right);
    let squared = dot(normal, normal);
    return Face(left, right, scales, normal, squared, normal / sqrt(squared));
}

// Parameters along L and R of a vector from the corner of a polygon, or of a velocity.
fn along_edges(face: Face, v: vec3f) -> vec2f {
    let l = dot(cross(v, face.right), face.across) / face.squared;
    let k = dot(cross(face.left, v), face.across) / face.squared;
    return face.scales * vec2f(l, k);
}

fn on_face(place: vec2f) -> bool {
    return unit_interval(place.x) & unit_interval(place.y);
}

// The nearest point of a polygon, P + l L + k R.
struct OnPolygon {
    l: f32,
    k: f32,
    is_face: bool,
    // The edge that the point is on. 0 for a point of the face and for a corner.
    edge: vec3f,
}

// The point of the edge across a side of a polygon that is nearest to a point beside it. `side` is L or R, `edge` the other one, and
// `place` the parameter along `side` of the point `t`, as seen from the corner. w: the squared distance. x, y: the parameters along
// `side` and `edge`. z: 1 for a corner.
fn nearest_on_edge(side: vec3f, edge: vec3f, place: f32, t: vec3f) -> vec4f {
    let beyond = select(0.0, 1.0, place > 0.5);
    let from_start = t - beyond * side;
    let along = dot(from_start, edge) / dot(edge, edge);
    let clamped = clamp(along, 0.0, 1.0);
    let distance = clamped * edge - from_start;
    return vec4f(beyond, clamped, select(0.0, 1.0, clamped != along), dot(distance, distance));
}

// The point of a polygon that is nearest to the point `t`, as seen from the corner. `place` are its parameters along the edges.
fn nearest_on_polygon(polygon: Polygon, place: vec2f, t: vec3f) -> OnPolygon {
    if is_triangle(polygon) {
        return nearest_on_triangle(polygon, place, t);
    }
    if on_face(place) || is_plane(polygon) {
        return OnPolygon(place.x, place.y, true, vec3f(0.0));
    }
    var nearest = OnPolygon(0.0, 0.0, false, vec3f(0.0));
    var least = 3e38;
    if !unit_interval(place.x) {
        let found = nearest_on_edge(polygon.left, polygon.right, place.x, t);
        nearest = OnPolygon(found.x, found.y, false, select(polygon.right, vec3f(0.0), found.z > 0.0));
        least = found.w;
    }
    if !unit_interval(place.y) {
        let found = nearest_on_edge(polygon.right, polygon.left, place.y, t);
        if found.w < least {
            nearest = OnPolygon(found.y, found.x, false, select(polygon.left, vec3f(0.0), found.z > 0.0));
        }
    }
    return nearest;
}

// The point of an edge of a triangle, from `start`, that is nearest to a point: the parameter along the edge, the squared distance, and 1
// unless it is a vertex.
fn nearest_on_side(start: vec3f, edge: vec3f, t: vec3f) -> vec3f {
    let along = dot(t - start, edge) / dot(edge, edge);
    let clamped = clamp(along, 0.0, 1.0);
    let distance = start + clamped * edge - t;
    return vec3f(clamped, dot(distance, distance), select(0.0, 1.0, clamped == along));
}

// The point of a triangle that is nearest to the point `t`.
fn nearest_on_triangle(polygon: Polygon, place: vec2f, t: vec3f) -> OnPolygon {
    if on_face(place) & unit_interval(place.x + place.y) {
        return OnPolygon(place.x, place.y, true, vec3f(0.0));
    }
    let third = polygon.right - polygon.left;
    let on_left = nearest_on_side(vec3f(0.0), polygon.left, t);
    let on_right = nearest_on_side(vec3f(0.0), polygon.right, t);
    let on_third = nearest_on_side(polygon.left, third, t);
    var nearest = OnPolygon(on_left.x, 0.0, false, on_left.z * polygon.left);
    var least = on_left.y;
    if on_right.y < least {
        nearest = OnPolygon(0.0, on_right.x, false, on_right.z * polygon.right);
        least = on_right.y;
    }
    if on_third.y < least {
        nearest = OnPolygon(1.0 - on_third.x, on_third.x, false, on_third.z * third);
    }
    return nearest;
}

// Contact with a point on the edges of a polygon. `to_edge` points there from the centre of a sphere.
fn touch_edge_of_polygon(radius: f32, polygon: Polygon, face: Face, nearest: OnPolygon, to_edge: vec3f) -> Touch {
    var apart = to_edge;
    let squared_edge = dot(nearest.edge, nearest.edge);
    if squared_edge > 0.0 {
        apart = across(apart, nearest.edge, squared_edge);
    }
    let distance = unrounded(apart, max(dot(polygon.left, polygon.left), dot(polygon.right, polygon.right)), radius);
    return touch_at(distance, radius, 0.0, 0.0, -face.n);
}

// A face as it is seen from a height above its plane. The normal of a triangle points to that side.
fn face_seen_from(face: Face, height: f32, polygon: Polygon) -> Face {
    var seen = face;
    if is_triangle(polygon) && (height < 0.0) {
        seen.n = -face.n;
    }
    return seen;
}

// Contact of a sphere with a polygon: its face, an edge or a corner. The overlap is negative when they are apart. There is no contact
// behind the plane of a parallelogram.
fn touch_sphere_polygon(centre: vec4f, polygon: Polygon) -> Touch {
    let from_corner = centre.xyz - polygon.corner;
    if is_round(polygon) {
        return touch_round(centre.w, polygon, Fine(from_corner, vec3f(0.0)));
    }
    let front = face_of(polygon);
    let face = face_seen_from(front, dot(from_corner, front.n), polygon);
    let height = dot(from_corner, face.n);
    if !(height >= 0.0) {
        return no_touch();
    }
    let nearest = nearest_on_polygon(polygon, along_edges(face, from_corner), from_corner);
    if nearest.is_face {
        return Touch(-face.n, centre.w - height, 0.0, 0.0);
    }
    let to_edge = polygon.corner + nearest.l * polygon.left + nearest.k * polygon.right - centre.xyz;
    return touch_edge_of_polygon(centre.w, polygon, face, nearest, to_edge);
}

// The same for a position with a low part.
fn touch_polygon_finely(i: u32, radius: f32, polygon: Polygon) -> Touch {
    let from_corner = fine_from_corner(polygon.corner, middle_of_polygon(polygon), i);
    if is_round(polygon) {
        return touch_round(radius, polygon, from_corner);
    }
    let front = face_of(polygon);
    let nearest = nearest_on_polygon(polygon, along_edges(front, from_corner.high), from_corner.high);
    // The parts along the edges do not change the height. Without them the rest is small, so the rounding of the normal matters little.
    var rest = from_corner;
    rest = fine_sum(rest, product_of(vec3f(-nearest.l), polygon.left));
    rest = fine_sum(rest, product_of(vec3f(-nearest.k), polygon.right));
    let face = face_seen_from(front, dot(rest.high, front.n), polygon);
    let height = dot(rest.high, face.n);
    if !(height >= 0.0) {
        return no_touch();
    }
    if nearest.is_face {
        return Touch(-face.n, radius - height - dot(rest.low, face.n), 0.0, 0.0);
    }
    var found = touch_edge_of_polygon(radius, polygon, face, nearest, -rest.high);
    if found.overlap < radius {
        found.overlap += dot(rest.low, found.n);
    }
    return found;
}

// Whether a point is over a face of a box, neither beside it nor inside the box.
fn is_over_box(point: vec3f, box: Cuboid) -> bool {
    let beside = abs(box_parameters(point, box) - 0.5) > vec3f(0.5);
    return dot(select(vec3f(0.0), vec3f(1.0), beside), vec3f(1.0)) == 1.0;
}

// Whether the centre of a sphere is over the face of a polygon, neither beside nor behind it. A triangle has a face on both sides, a cone or
// ball has none.
fn is_over_polygon(centre: vec3f, polygon: Polygon) -> bool {
    let face = face_of(polygon);
    let from_corner = centre - polygon.corner;
    let place = along_edges(face, from_corner);
    if is_triangle(polygon) {
        return on_face(place) & unit_interval(place.x + place.y);
    }
    let is_inside = on_face(place) || is_plane(polygon);
    return is_inside & (dot(from_corner, face.n) >= 0.0) & !is_round(polygon);
}

// Edge vector of a box: I, J, K for g modulo 3 = 0, 1, 2.
fn box_edge(box: Cuboid, g: u32) -> vec3f {
    let turn = g % 3u;
    return select(select(box.k, box.j, turn == 1u), box.i, turn == 0u);
}

// Contact of a rod with an edge or vertex of a box. `a` is the parameter of the axis point, and `distance` points from there to
// the edge or vertex. The rod is pushed outward, even when the axis point is inside the box. The overlap is negative when they
// are apart.
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
    let offset = vec2f(f32(feature & 1u), f32((feature >> 1u) & 1u));
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
    let offset = vec3f(f32(feature & 1u), f32((feature >> 1u) & 1u), f32((feature >> 2u) & 1u));
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

// Feature f is edge f, or, when no edge is hit, vertex f. The vertex is tested before the other edges, because its test is
// cheap and nearly always fails. Then the other edges need no test.
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

// Inverse mass of an object at the contact: (2.6) for a rod, 0 for a box or polygon. `at` is the parameter on a rod.
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

// Contact of a rod with another object. `id` and `own` are the id and the data of the rod.
fn touch_bar(id: u32, own: Bar, other: u32, feature: u32) -> Touch {
    let boxes = step.spheres + step.rods;
    if other < step.spheres {
        return touch_sphere_rod(other, ball_from(own.ends.x, other), own);
    }
    if ROD_POLYGONS {
        if other >= boxes + step.boxes {
            let face = polygon_from(own.ends.x, polygon(other - boxes - step.boxes));
            return touch_axis(own.axis, face, feature, false).touch;
        }
    }
    if other >= boxes {
        return touch_rod_box(own.axis, box_from(own.ends.x, cuboid(other - boxes)), feature);
    }
    if other < id {
        let a = bar_of(other - step.spheres);
        return touch_rods(a, bar_from(id - step.spheres, a.ends.x));
    }
    return touch_rods(own, bar_from(other - step.spheres, own.ends.x));
}

// Position and radius of a sphere as seen from another one.
fn ball_from(origin: u32, sphere: u32) -> vec4f {
    return vec4f(place_from(origin, sphere), state[position_at(sphere)].w);
}

// Contact of a sphere with an object that is not a sphere. `i` is the id of the sphere, `own` its position and radius.
fn touch_static_or_rod(i: u32, id: u32, own: vec4f) -> Touch {
    if id < step.spheres + step.rods {
        if RODS {
            let bar = bar_of(id - step.spheres);
            return touch_sphere_rod(i, vec4f(place_from(bar.ends.x, i), own.w), bar);
        }
        return no_touch();
    }
    return touch_static(i, id, own);
}

// Contact of a sphere with a box or polygon.
fn touch_static(i: u32, id: u32, own: vec4f) -> Touch {
    let boxes = step.spheres + step.rods;
    if id < boxes + step.boxes {
        if DOUBLE {
            return touch_box_finely(i, own.w, cuboid(id - boxes));
        }
        return touch_sphere_box(own, cuboid(id - boxes));
    }
    if DOUBLE {
        return touch_polygon_finely(i, own.w, polygon(id - boxes - step.boxes));
    }
    return touch_sphere_polygon(own, polygon(id - boxes - step.boxes));
}

// Contact of a sphere with another object. `id` is the id of the sphere, `own` its position and radius.
fn touch_ball(id: u32, own: vec4f, other: u32) -> Touch {
    if other >= step.spheres {
        return touch_static_or_rod(id, other, own);
    }
    let ball = state[position_at(other)];
    let first = ordered(id, other).x == id;
    var found: Touch;
    if DOUBLE {
        let pair = select(vec2u(other, id), vec2u(id, other), first);
        found = touch_spheres_finely(fine_between(pair.x, pair.y), own.w, ball.w);
    } else {
        found = touch_spheres(select(ball, own, first), select(own, ball, first));
    }
    if found.overlap > 0.0 {
        if joined(id, bonded_partner(id), other) {
            return no_touch();
        }
    }
    return found;
}

// Data of a mover that is read once for all entries of its list: the position and radius of a sphere, or a rod.
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

// Contact of a mover with another object, whatever their masses are. The result is bitwise identical from both sides.
fn touch_with(own: Own, id: u32, feature: u32) -> Touch {
    if own.id < step.spheres {
        return touch_ball(own.id, own.place, id);
    }
    if RODS {
        return touch_bar(own.id, own.bar, id, feature);
    }
    return no_touch();
}
