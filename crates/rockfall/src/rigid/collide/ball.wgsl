// requires rigid/collide/manifold.wgsl rigid/collide/solid.wgsl

// A ball against everything (docs/physics section 11.13).

// The place of a core nearest to a point, and the unit vector from there to the point, or outwards.
struct CorePlace {
    place: vec3f,
    normal: vec3f,
    // False behind a one-sided face.
    exists: bool,
}

// From a place to a point, or another direction if rounding errors are all that is between them.
fn direction_to(place: vec3f, point: vec3f, otherwise: vec3f) -> CorePlace {
    let offset = point - place;
    let size = length(offset);
    let is_apart = size > max(2.0 * EPSILON * greatest_of(abs(point)), 1.0842022e-19);
    return CorePlace(place, select(otherwise, offset / size, is_apart), true);
}

fn place_on_segment(start: vec3f, end: vec3f, point: vec3f) -> vec3f {
    let along = end - start;
    let square = dot(along, along);
    if square <= 0.0 {
        return start;
    }
    return start + clamp(dot(point - start, along) / square, 0.0, 1.0) * along;
}

fn place_on_core_box(extent: vec3f, point: vec3f) -> CorePlace {
    let depths = extent - abs(point);
    let least = least_of(depths);
    if least < 0.0 {
        let place = clamp(point, -extent, extent);
        let offset = point - place;
        return CorePlace(place, normalize(offset / greatest_of(abs(offset))), true);
    }
    let is_x = depths.x == least;
    let is_y = !is_x && depths.y == least;
    let is_axis = vec3<bool>(is_x, is_y, !is_x && !is_y);
    let sides = vec3f(unit_sign(point.x), unit_sign(point.y), unit_sign(point.z));
    return CorePlace(select(point, sides * extent, is_axis), select(vec3f(0.0), sides, is_axis), true);
}

fn place_on_core_face(shape: Shape, point: vec3f) -> CorePlace {
    let foot = vec3f(point.xy, 0.0);
    let count = corners_of_core_face(shape);
    var is_inside = true;
    var best = 3e38;
    var place = foot;
    for (var k = 0u; k < 4u && k < count; k++) {
        let start = vertex_of_core_face(shape, k);
        let end = vertex_of_core_face(shape, select(k + 1u, 0u, k + 1u == count));
        is_inside &= cross(end - start, foot - start).z >= 0.0;
        let found = place_on_segment(start, end, foot);
        let square = dot(found.xy - foot.xy, found.xy - foot.xy);
        if square < best {
            best = square;
            place = found;
        }
    }
    place = select(place, foot, is_inside);
    var found = direction_to(place, point, vec3f(0.0, 0.0, unit_sign(point.z)));
    found.exists = (shape.more & FACET) == 0u && ((shape.more & ONE_SIDED) == 0u || point.z >= 0.0);
    return found;
}

fn place_on_core_hull(shape: Shape, point: vec3f) -> CorePlace {
    var least_height = NO_SEPARATION;
    var inside = CorePlace(point, vec3f(0.0), true);
    var best = 3e38;
    var outside = inside;
    for (var face = 0u; face < 32u && face < faces_of_core(shape); face++) {
        let normal = normal_of_core(shape, face);
        let corners = corners_of_core(shape, face);
        let height = dot(point - vertex_of_core(shape, corner_of_core(shape, face, 0u)), normal);
        if height > least_height {
            least_height = height;
            inside = CorePlace(point - height * normal, normal, true);
        }
        if height <= 0.0 {
            continue;
        }
        let foot = point - height * normal;
        var square = 3e38;
        var found = CorePlace(foot, normal, true);
        for (var k = 0u; k < 64u && k < corners; k++) {
            let start = vertex_of_core(shape, corner_of_core(shape, face, k));
            let end = vertex_of_core(shape, corner_of_core(shape, face, select(k + 1u, 0u, k + 1u == corners)));
            let place = place_on_segment(start, end, point);
            let offset = place - point;
            if dot(foot - start, cross(end - start, normal)) > 0.0 && dot(offset, offset) < square {
                square = dot(offset, offset);
                found = direction_to(place, point, normal);
            }
        }
        let offset = found.place - point;
        if dot(offset, offset) < best {
            best = dot(offset, offset);
            outside = found;
        }
    }
    if least_height > 0.0 {
        return outside;
    }
    return inside;
}

// In the half-plane that the axis bounds and that contains the point: x is the distance from the axis there.
fn place_on_core_cone(shape: Shape, point: vec3f) -> CorePlace {
    let far = length(point.xz);
    var out = vec3f(1.0, 0.0, 0.0);
    if far > 0.0 {
        out = vec3f(point.x, 0.0, point.z) / far;
    }
    let low = vec2f(shape.size.y, -shape.size.x);
    let edge = vec2f(shape.size.z, shape.size.x) - low;
    let offset = vec2f(far, point.y) - low;
    let side = select(1.0, -1.0, shape.more == CONE_FROM_INSIDE);
    let flat_normal = side * vec2f(edge.y, -edge.x) / length(edge);
    let nearest = low + clamp(dot(offset, edge) / dot(edge, edge), 0.0, 1.0) * edge;
    let up = vec3f(0.0, 1.0, 0.0);
    var found = direction_to(nearest.x * out + nearest.y * up, point, flat_normal.x * out + flat_normal.y * up);
    found.exists = dot(offset, flat_normal) >= 0.0;
    return found;
}

fn place_on_core_smooth(shape: Shape, point: vec3f) -> CorePlace {
    if shape.more == HALF_SPACE {
        return CorePlace(vec3f(point.x, 0.0, point.z), vec3f(0.0, 1.0, 0.0), true);
    }
    if shape.more == BOWL {
        let far = length(point);
        var out = vec3f(0.0, 1.0, 0.0);
        if far > 0.0 {
            out = point / far;
        }
        return CorePlace(shape.size.x * out, -out, far <= shape.size.x);
    }
    return place_on_core_cone(shape, point);
}

fn place_on_core(shape: Shape, point: vec3f) -> CorePlace {
    if shape.core == CORE_SMOOTH {
        return place_on_core_smooth(shape, point);
    }
    if shape.core == CORE_FACE {
        return place_on_core_face(shape, point);
    }
    if shape.core == CORE_BOX {
        return place_on_core_box(shape.size.xyz, point);
    }
    if HULLS & (shape.core == CORE_HULL) {
        return place_on_core_hull(shape, point);
    }
    let is_segment = shape.core == CORE_SEGMENT;
    let half = select(0.0, shape.size.x, is_segment);
    let otherwise = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), is_segment);
    return direction_to(vec3f(0.0, clamp(point.y, -half, half), 0.0), point, otherwise);
}

// A ball b with its centre at a position in coordinates of a.
fn collide_ball(a: Shape, radius: f32, position: vec3f, reach: f32) -> Manifold {
    let found = place_on_core(a, position);
    let separation = dot(position - found.place, found.normal) - a.radius - radius;
    if !found.exists || separation > reach {
        return no_contact();
    }
    return one_point(found.normal, found.place, position, vec2f(a.radius, radius), 0u);
}
