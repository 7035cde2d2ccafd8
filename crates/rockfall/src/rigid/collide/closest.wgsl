// requires rigid/collide/manifold.wgsl rigid/collide/solid.wgsl

// Closest points of two sets of vertices: the method of Gilbert, Johnson and Keerthi (docs/physics section 11.13).

struct ClosestPoints {
    on_a: vec3f,
    // 0 if the sets overlap.
    apart: f32,
    on_b: vec3f,
    // Unit vector from a to b; not defined if the sets overlap.
    normal: vec3f,
    // The least numbers of the vertices that span the nearest features.
    of_a: u32,
    of_b: u32,
}

// Corners of the difference b - a: vertices of both, their offset, and the part of the nearest point.
struct Simplex {
    count: u32,
    numbers: array<vec2u, 4>,
    offsets: array<vec3f, 4>,
    weights: vec4f,
}

// The first vertex that is farthest along a direction.
fn farthest_vertex(solid: Solid, direction: vec3f) -> u32 {
    let own = direction * solid.axes;
    var best = NO_SEPARATION;
    var found = 0u;
    for (var k = 0u; k < 64u && k < vertices_of_core(solid.shape); k++) {
        let along = dot(vertex_of_core(solid.shape, k), own);
        if along > best {
            best = along;
            found = k;
        }
    }
    return found;
}

// Weights of the foot of the origin on the plane of the corners in a set of bits; the sum is 0 if the foot is not among them.
fn weights_of_foot(simplex: ptr<function, Simplex>, corners: u32) -> vec4f {
    var numbers = vec4u(0u);
    var count = 0u;
    for (var k = 0u; k < 4u; k++) {
        if ((corners >> k) & 1u) == 1u {
            numbers[count] = k;
            count++;
        }
    }
    let p = (*simplex).offsets[numbers.x];
    let u = (*simplex).offsets[numbers.y] - p;
    let v = (*simplex).offsets[numbers.z] - p;
    let w = (*simplex).offsets[numbers.w] - p;
    var parts = vec4f(1.0, 0.0, 0.0, 0.0);
    var size = 1.0;
    if count == 2u {
        size = dot(u, u);
        parts = vec4f(0.0, -dot(p, u), 0.0, 0.0);
    } else if count == 3u {
        let normal = cross(u, v);
        size = dot(normal, normal);
        parts = vec4f(0.0, -dot(cross(p, v), normal), -dot(cross(u, p), normal), 0.0);
    } else if count == 4u {
        size = dot(u, cross(v, w));
        parts = -vec4f(0.0, dot(p, cross(v, w)), dot(u, cross(p, w)), dot(u, cross(v, p)));
    }
    if count > 1u {
        if abs(size) < 1e-30 {
            return vec4f(0.0);
        }
        parts /= size;
        parts.x = 1.0 - parts.y - parts.z - parts.w;
    }
    var weights = vec4f(0.0);
    for (var k = 0u; k < count; k++) {
        // Written so that what is not a number is refused.
        if !(parts[k] > 0.0 && parts[k] < 1.000001) {
            return vec4f(0.0);
        }
        weights[numbers[k]] = parts[k];
    }
    return weights;
}

fn nearest_of_simplex(simplex: ptr<function, Simplex>) -> vec3f {
    let weights = (*simplex).weights;
    return weights.x * (*simplex).offsets[0] + weights.y * (*simplex).offsets[1] + weights.z * (*simplex).offsets[2]
        + weights.w * (*simplex).offsets[3];
}

// Leaves the corners of the least face that has its point nearest to the origin.
fn reduce_simplex(simplex: ptr<function, Simplex>) {
    var best = 3e38;
    var corners = 1u;
    var weights = vec4f(1.0, 0.0, 0.0, 0.0);
    for (var tried = 1u; tried < 16u && tried < (1u << (*simplex).count); tried++) {
        let found = weights_of_foot(simplex, tried);
        if found.x + found.y + found.z + found.w > 0.5 {
            (*simplex).weights = found;
            let place = nearest_of_simplex(simplex);
            let square = select(dot(place, place), 0.0, tried == 15u);
            if square < best {
                best = square;
                corners = tried;
                weights = found;
            }
        }
    }
    var kept = 0u;
    var left = vec4f(0.0);
    for (var k = 0u; k < 4u; k++) {
        if ((corners >> k) & 1u) == 1u {
            (*simplex).numbers[kept] = (*simplex).numbers[k];
            (*simplex).offsets[kept] = (*simplex).offsets[k];
            left[kept] = weights[k];
            kept++;
        }
    }
    (*simplex).count = kept;
    (*simplex).weights = left;
}

// The direction of the nearest point. The edge or triangle that has it tells that better than its own few digits.
fn normal_of_simplex(simplex: ptr<function, Simplex>, nearest: vec3f) -> vec3f {
    let u = (*simplex).offsets[1] - (*simplex).offsets[0];
    let v = (*simplex).offsets[2] - (*simplex).offsets[0];
    var normal = nearest;
    if (*simplex).count == 2u {
        normal -= u * (dot(nearest, u) / dot(u, u));
    } else if (*simplex).count == 3u {
        let product = cross(u, v);
        if dot(product, product) > 1e-6 * dot(u, u) * dot(v, v) {
            normal = product * unit_sign(dot(product, nearest));
        }
    }
    return normalize(normal);
}

fn closest_of_solids(a: Solid, b: Solid) -> ClosestPoints {
    var simplex = Simplex();
    var direction = vertex_of(a, 0u) - vertex_of(b, 0u);
    var nearest = vec3f(0.0);
    var square = 3e38;
    // The first round finds the first corner.
    for (var round = 0u; round < 41u; round++) {
        let next = vec2u(farthest_vertex(a, -direction), farthest_vertex(b, direction));
        let offset = vertex_of(b, next.y) - vertex_of(a, next.x);
        var is_known = false;
        var scale = 0.0;
        for (var k = 0u; k < 4u && k < simplex.count; k++) {
            is_known = is_known || all(simplex.numbers[k] == next);
            scale = max(scale, dot(simplex.offsets[k], simplex.offsets[k]));
        }
        // The direction is a unit vector against the nearest point.
        let is_last = is_known || square <= 1e-13 * scale || sqrt(square) + dot(direction, offset) <= 1e-7 * sqrt(square);
        if round > 0u && is_last {
            break;
        }
        let before = simplex;
        simplex.numbers[simplex.count] = next;
        simplex.offsets[simplex.count] = offset;
        simplex.count++;
        reduce_simplex(&simplex);
        let found = nearest_of_simplex(&simplex);
        let found_square = dot(found, found);
        if found_square >= square {
            simplex = before;
            break;
        }
        nearest = found;
        square = found_square;
        direction = -normal_of_simplex(&simplex, found);
        if simplex.count == 4u {
            nearest = vec3f(0.0);
            break;
        }
    }
    var points = ClosestPoints(vec3f(0.0), length(nearest), vec3f(0.0), normal_of_simplex(&simplex, nearest), 255u, 255u);
    for (var k = 0u; k < 4u && k < simplex.count; k++) {
        let numbers = simplex.numbers[k];
        points.on_a += simplex.weights[k] * vertex_of(a, numbers.x);
        points.on_b += simplex.weights[k] * vertex_of(b, numbers.y);
        points.of_a = min(points.of_a, numbers.x);
        points.of_b = min(points.of_b, numbers.y);
    }
    return points;
}
