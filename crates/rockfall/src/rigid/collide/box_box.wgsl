// requires rigid/collide/manifold.wgsl rigid/collide/reduce.wgsl rigid/collide/solid.wgsl

// Two boxes without radii (docs/physics section 11.13).
//
// An axis i is chosen by turning the coordinates in a ring (`cycled`), so that it is x and the axes i + 1 and i + 2 are y and z: no
// vector is indexed by a variable.

// As a number of points: the general pair must decide.
const UNDECIDED: u32 = 5u;

// In coordinates of a: half the edges of both, the axes of b, and the way from a to b.
struct BoxPair {
    half_a: vec3f,
    half_b: vec3f,
    axes: mat3x3f,
    way: vec3f,
}

// Corners of a face, each with the label of the edge after it.
struct ClippedFace {
    count: u32,
    corners: array<vec3f, 8>,
    labels: array<u32, 8>,
}

// The coordinates in a ring, from number i on.
fn cycled(v: vec3f, i: u32) -> vec3f {
    return select(select(v.zxy, v.yzx, i == 1u), v, i == 0u);
}

// Takes `cycled` back.
fn uncycled(v: vec3f, i: u32) -> vec3f {
    return select(select(v.yzx, v.zxy, i == 1u), v, i == 0u);
}

// The columns in a ring, from number j on.
fn cycled_columns(m: mat3x3f, j: u32) -> mat3x3f {
    if j == 0u {
        return m;
    }
    if j == 1u {
        return mat3x3f(m[1], m[2], m[0]);
    }
    return mat3x3f(m[2], m[0], m[1]);
}

fn absolute_columns(m: mat3x3f) -> mat3x3f {
    return mat3x3f(abs(m[0]), abs(m[1]), abs(m[2]));
}

// The separations along the products of all edges of a with the one of b along `column`. `across` holds the reach of b along the axes of a
// times the column, `noise` the rounding error.
fn gaps_of_edges(pair: BoxPair, column: vec3f, across: vec3f, noise: f32) -> vec3f {
    let along = abs(cross(pair.way, column));
    let next = abs(column.yzx);
    let last = abs(column.zxy);
    let square = next * next + last * last;
    let gap = along - pair.half_a.yzx * last - pair.half_a.zxy * next - across - noise;
    return select(gap * inverseSqrt(max(square, vec3f(1e-6))), vec3f(NO_SEPARATION), square < vec3f(1e-6));
}

// One point between edge i of a and edge j of b. None if the nearest points of their lines are beyond the edges.
fn contact_of_edges(pair: BoxPair, i: u32, j: u32, reach: f32) -> Manifold {
    let half_a = cycled(pair.half_a, i);
    let half_b = cycled(pair.half_b, j);
    let way = cycled(pair.way, i);
    let axes = cycled_columns(pair.axes, j);
    let across = cycled(axes[0], i);
    let beside = cycled(axes[1], i);
    let last = cycled(axes[2], i);

    // The product of both directions; the first one is x.
    let product = vec3f(0.0, -across.z, across.y);
    let square = dot(product, product);
    if square < 1e-7 {
        return no_contact();
    }
    var normal = product * inverseSqrt(square);
    normal *= unit_sign(dot(normal, way));
    let sides_a = vec2f(unit_sign(normal.y), unit_sign(normal.z));
    let sides_b = vec2f(unit_sign(-dot(normal, beside)), unit_sign(-dot(normal, last)));
    let middle_a = vec3f(0.0, sides_a * half_a.yz);
    let middle_b = way + sides_b.x * half_b.y * beside + sides_b.y * half_b.z * last;
    let offset = middle_b - middle_a;
    let s = dot(cross(offset, across), product) / square;
    // The product of the offset with x.
    let t = dot(vec3f(0.0, offset.z, -offset.y), product) / square;
    if abs(s) > 1.0001 * half_a.x || abs(t) > 1.0001 * half_b.x {
        return no_contact();
    }
    let on_a = middle_a + vec3f(s, 0.0, 0.0);
    let on_b = middle_b + t * across;
    if dot(on_b - on_a, normal) > reach {
        return no_contact();
    }
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), vec4f(normal.yz, sides_b) > vec4f(0.0));
    let code = 16u * (3u * i + j) + bits.x + bits.y + bits.z + bits.w;
    return one_point(uncycled(normal, i), uncycled(on_a, i), uncycled(on_b, i), vec2f(0.0), id_of_edges(code, 0u));
}

// Removes what lies beyond a bound of y or z. The new edge gets a label.
fn cut_face(face: ptr<function, ClippedFace>, is_z: bool, side: f32, bound: f32, label: u32) {
    var before = *face;
    var count = 0u;
    for (var k = 0u; k < MOST_CANDIDATES && k < before.count; k++) {
        let start = before.corners[k];
        let end = before.corners[select(k + 1u, 0u, k + 1u == before.count)];
        let above = side * select(start.y, start.z, is_z) - bound;
        let below = side * select(end.y, end.z, is_z) - bound;
        if above <= 0.0 && count < MOST_CANDIDATES {
            (*face).corners[count] = start;
            (*face).labels[count] = before.labels[k];
            count++;
        }
        if (above > 0.0) != (below > 0.0) && count < MOST_CANDIDATES {
            let crossing = start + (end - start) * (above / (above - below));
            let exact = side * bound;
            (*face).corners[count] = select(vec3f(crossing.x, exact, crossing.z), vec3f(crossing.xy, exact), is_z);
            (*face).labels[count] = select(label, before.labels[k], above > 0.0);
            count++;
        }
    }
    (*face).count = count;
}

// The face of b that is most against the one of a along axis i, clipped above that.
fn contact_of_face(pair: BoxPair, i: u32, b_is_reference: bool, reach: f32) -> Manifold {
    let size = min(least_of(pair.half_a), least_of(pair.half_b));
    let half_a = cycled(pair.half_a, i);
    let way = cycled(pair.way, i);
    let side = unit_sign(way.x);

    // The incident face, on axis k of b.
    let rows = transpose(pair.axes);
    let row = select(select(rows[2], rows[1], i == 1u), rows[0], i == 0u);
    let against = abs(row);
    var k = select(0u, 1u, against.y > against.x + 1e-4);
    k = select(k, 2u, against.z > select(against.x, against.y, k == 1u) + 1e-4);
    let half_b = cycled(pair.half_b, k);
    let axes = cycled_columns(pair.axes, k);
    let out_b = select(1.0, -1.0, side * cycled(row, k).x > 0.0);

    // Coordinates: the height above the reference face, then the axes i + 1 and i + 2.
    let flat = vec3f(side, 1.0, 1.0);
    let middle = (way + out_b * half_b.x * cycled(axes[0], i)) * flat - vec3f(half_a.x, 0.0, 0.0);
    let p = half_b.y * cycled(axes[1], i) * flat;
    let q = half_b.z * cycled(axes[2], i) * flat;
    var face: ClippedFace;
    face.count = 4u;
    face.corners[0] = middle - p - q;
    face.corners[1] = middle + p - q;
    face.corners[2] = middle + p + q;
    face.corners[3] = middle - p + q;
    for (var corner = 0u; corner < 4u; corner++) {
        face.labels[corner] = corner;
    }
    let extent = abs(p.yz) + abs(q.yz);
    let slack = vec2f(1e-4 * size);
    let is_beyond_high = middle.yz + extent > half_a.yz + slack;
    let is_beyond_low = middle.yz - extent < -half_a.yz - slack;
    let is_beyond = vec4<bool>(is_beyond_high.x, is_beyond_low.x, is_beyond_high.y, is_beyond_low.y);
    for (var cut = 0u; cut < 4u; cut++) {
        if is_beyond[cut] {
            cut_face(&face, cut >= 2u, select(1.0, -1.0, (cut & 1u) == 1u), select(half_a.y, half_a.z, cut >= 2u), 4u + cut);
        }
    }

    // Corners that touch, as those of diagonal neighbours in a lattice, must not hold each other.
    var low = vec2f(3e38);
    var high = vec2f(NO_SEPARATION);
    for (var corner = 0u; corner < MOST_CANDIDATES && corner < face.count; corner++) {
        low = min(low, face.corners[corner].yz);
        high = max(high, face.corners[corner].yz);
    }
    if face.count == 0u || any(high - low < vec2f(1e-3 * size)) {
        return no_contact();
    }

    let reference = 2u * i + select(0u, 1u, side < 0.0);
    let incident = 2u * k + select(0u, 1u, out_b < 0.0);
    var candidates: Candidates;
    candidates.count = 0u;
    var before = face.labels[face.count - 1u];
    for (var corner = 0u; corner < MOST_CANDIDATES && corner < face.count; corner++) {
        let place = face.corners[corner];
        let after = face.labels[corner];
        if place.x <= reach {
            candidates.places[candidates.count] = vec4f(uncycled(vec3f(side * half_a.x, place.yz), i), place.x);
            candidates.ids[candidates.count] = id_of_corner(b_is_reference, reference, incident, before, after);
            candidates.count++;
        }
        before = after;
    }
    let along = uncycled(vec3f(0.0, 1.0, 0.0), i);
    return reduced(&candidates, uncycled(vec3f(side, 0.0, 0.0), i), along, vec2f(0.0));
}

// One point between the closest points of two boxes that are apart; none beyond reach, or if they are nearer than `nearest`.
fn contact_of_closest_boxes(pair: BoxPair, reach: f32, nearest: f32) -> Manifold {
    var best = 3e38;
    var on_a = vec3f(0.0);
    var on_b = vec3f(0.0);
    var id = 0u;
    let bits = vec3u(1u, 2u, 4u);
    for (var k = 0u; k < 16u; k++) {
        let of_b = k < 8u;
        // A vertex of one box and the nearest place of the other one, in coordinates of that.
        let vertex = vertex_of_box(select(pair.half_a, pair.half_b, of_b), k & 7u);
        let turned = pair.way + pair.axes * vertex;
        let seen = select((vertex - pair.way) * pair.axes, turned, of_b);
        let extent = select(pair.half_b, pair.half_a, of_b);
        let place = clamp(seen, -extent, extent);
        let offset = place - seen;
        let square = dot(offset, offset);
        if square < best {
            best = square;
            on_a = select(vertex, place, of_b);
            on_b = select(pair.way + pair.axes * place, turned, of_b);
            let feature = select(vec3u(0u), bits, seen >= extent);
            let lowest = feature.x + feature.y + feature.z;
            id = select(id_of_closest(k & 7u, lowest), id_of_closest(lowest, k & 7u), of_b);
        }
    }
    for (var k = 0u; k < 9u; k++) {
        let i = k / 3u;
        let j = k - 3u * i;
        let edges = contact_of_edges(pair, i, j, 3e38);
        let offset = edges.on_b[0] - edges.on_a[0];
        let square = dot(offset, offset);
        // Only edges that face each other: the supporting ones of the direction between them.
        if edges.count == 1u && square < best && dot(offset, edges.normal) > 0.0 {
            best = square;
            on_a = edges.on_a[0];
            on_b = edges.on_b[0];
            let code = edges.ids[0] >> 12u;
            let of_a = cycled_bits(code & 3u, i);
            let of_b = cycled_bits((code >> 2u) & 3u, j);
            id = id_of_closest(of_a, of_b);
        }
    }
    let apart = sqrt(best);
    if apart > reach || apart <= nearest {
        return no_contact();
    }
    return one_point(normalize(on_b - on_a), on_a, on_b, vec2f(0.0), id);
}

// The number of the lower vertex of an edge along axis i of a box, from the signs of its coordinates i + 1 and i + 2.
fn cycled_bits(signs: u32, i: u32) -> u32 {
    let bits = signs << (i + 1u);
    return (bits & 7u) | (bits >> 3u);
}

// Two boxes in coordinates of a.
fn collide_boxes(half_a: vec3f, half_b: vec3f, way: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    let pair = BoxPair(half_a, half_b, axes, way);
    let size = min(least_of(half_a), least_of(half_b));
    let columns = absolute_columns(axes);
    let of_a = abs(way) - half_a - columns * half_b;
    let of_b = abs(way * axes) - half_b - half_a * columns;
    if max(greatest_of(of_a), greatest_of(of_b)) > reach {
        return no_contact();
    }
    var separations = array<f32, 6>(of_a.x, of_a.y, of_a.z, of_b.x, of_b.y, of_b.z);
    var face = separations[0];
    var axis = 0u;
    for (var k = 1u; k < 6u; k++) {
        if separations[k] > face + 0.02 * abs(face) + 1e-3 * size {
            face = separations[k];
            axis = k;
        }
    }

    let noise = 4.0 * EPSILON * (greatest_of(abs(way)) + greatest_of(half_a) + greatest_of(half_b));
    let gaps = transpose(mat3x3f(
        gaps_of_edges(pair, axes[0], half_b.y * columns[2] + half_b.z * columns[1], noise),
        gaps_of_edges(pair, axes[1], half_b.z * columns[0] + half_b.x * columns[2], noise),
        gaps_of_edges(pair, axes[2], half_b.x * columns[1] + half_b.y * columns[0], noise),
    ));
    let edge = greatest_of(max(gaps[0], max(gaps[1], gaps[2])));
    if edge > reach {
        return no_contact();
    }
    // The first pair of edges that is nearly the best.
    let enough = vec3f(edge - 0.02 * abs(edge) - 1e-3 * size);
    let is_enough = array<vec3<bool>, 3>(gaps[0] >= enough, gaps[1] >= enough, gaps[2] >= enough);
    let i = select(select(2u, 1u, any(is_enough[1])), 0u, any(is_enough[0]));
    let lanes = select(select(is_enough[2], is_enough[1], i == 1u), is_enough[0], i == 0u);
    let j = select(select(2u, 1u, lanes.y), 0u, lanes.x);

    var by_edges = contact_of_edges(pair, i, j, reach);
    if by_edges.count > 0u && edge > face + 0.05 * abs(face) + 0.01 * size {
        return by_edges;
    }
    let by_b = axis >= 3u;
    var own = pair;
    if by_b {
        own = BoxPair(half_b, half_a, transpose(axes), -(way * axes));
    }
    var by_face = contact_of_face(own, select(axis, axis - 3u, by_b), by_b, reach);
    if by_b {
        exchange_shapes(&by_face, way, axes);
    }
    let best = max(face, edge);
    let least = least_separation(&by_face);
    let is_beside = by_face.count > 0u && best > 0.0 && least > best + 0.02 * size + noise;
    let is_lattice = by_face.count == 0u && best > -0.01 * size - noise;
    let is_apart = max(greatest_of(max(of_a, of_b)), edge) > 0.0;
    if is_apart && (is_beside || is_lattice) {
        var closest = contact_of_closest_boxes(pair, reach, 1e-3 * size + noise);
        if closest.count > 0u && (is_lattice || least_separation(&closest) < least - 0.02 * size) {
            return closest;
        }
    }
    if by_face.count > 0u {
        return by_face;
    }
    if is_lattice {
        // The contact counts only if it is inside of both edges.
        let inset = 1e-3 * size;
        let at_a = abs(cycled(by_edges.on_a[0], i).x);
        let at_b = abs(cycled((by_edges.on_b[0] - way) * axes, j).x);
        let is_inside = at_a <= 1.0001 * cycled(half_a, i).x - inset && at_b <= 1.0001 * cycled(half_b, j).x - inset;
        by_edges.count = select(0u, by_edges.count, is_inside);
    } else if by_edges.count == 0u {
        by_edges.count = UNDECIDED;
    }
    return by_edges;
}
