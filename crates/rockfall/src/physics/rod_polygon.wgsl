// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl physics/round_pair.wgsl physics/scale.wgsl physics/smooth.wgsl

// The contact of the axis of a rod with an edge or vertex of a polygon, or with a cone or ball from outside (docs/physics section 2.19).

// The edge of a polygon that a feature stands for.
struct Rim {
    start: vec3f,
    along: vec3f,
}

fn rim_of(face: Polygon, feature: u32) -> Rim {
    if is_triangle(face) {
        if feature == 2u {
            return Rim(face.corner + face.left, face.right - face.left);
        }
        return Rim(face.corner, select(face.left, face.right, feature == 1u));
    }
    let along_right = feature >= 2u;
    let is_far = (feature & 1u) == 1u;
    let side = select(face.right, face.left, along_right);
    return Rim(face.corner + select(vec3f(0.0), side, is_far), select(face.left, face.right, along_right));
}

struct AxisTouch {
    touch: Touch,
    // The contact is with the end of an edge.
    is_vertex: bool,
}

fn no_axis_touch() -> AxisTouch {
    return AxisTouch(no_touch(), false);
}

// Contact of an axis with an edge, with a negative overlap where they are apart.
fn touch_axis_rim(rod: Axis, face: Polygon, rim: Rim) -> AxisTouch {
    let aa = dot(rod.along, rod.along);
    let ee = dot(rim.along, rim.along);
    if (aa <= TINY) | (ee <= TINY) {
        return no_axis_touch();
    }
    let a_scale = scale_of(rod.along);
    let e_scale = scale_of(rim.along);
    let a = a_scale * rod.along;
    let e = e_scale * rim.along;
    let normal = cross(a, e);
    let nn = dot(normal, normal);
    if nn <= 1e-8 * dot(a, a) * dot(e, e) {
        return no_axis_touch();
    }
    let to_start = rim.start - rod.start;
    let b = e_scale * (dot(to_start, cross(a, normal)) / nn);
    let is_vertex = !unit_interval(b);
    let to_place = to_start + select(b, clamp(b, 0.0, 1.0), is_vertex) * rim.along;
    let at = select(a_scale * (dot(to_start, cross(e, normal)) / nn), dot(to_place, rod.along) / aa, is_vertex);
    if !unit_interval(at) {
        return no_axis_touch();
    }
    let way = to_place - at * rod.along;
    let unit = normal / sqrt(nn);
    let apart = select(dot(way, unit) * unit, across(way, rod.along, aa), is_vertex);
    let distance = unrounded(apart, aa + ee, rod.radius);
    let front = cross(scale_of(face.left) * face.left, scale_of(face.right) * face.right);
    if !is_triangle(face) & (dot(distance, front) > 0.0) {
        return no_axis_touch();
    }
    return AxisTouch(touch_at(distance, rod.radius, at, 0.0, -normalize(front)), is_vertex);
}

// The point of an edge that is nearest to a place.
fn nearest_on_rim(rim: Rim, place: vec3f) -> vec3f {
    return rim.start + clamp(dot(place - rim.start, rim.along) / dot(rim.along, rim.along), 0.0, 1.0) * rim.along;
}

// The parameter of the point of an axis where it is nearest to a cone or ball, -1 if there is none.
fn lowest_on(rod: Axis, face: Polygon) -> f32 {
    let aa = dot(rod.along, rod.along);
    let to_axis = rod.start - face.corner;
    if aa <= TINY {
        return -1.0;
    }
    if face.surface == SURFACE_BALL {
        return -dot(rod.along, to_axis) / aa;
    }
    let cone = axis_of(face);
    let size = length(cone.along);
    let unit = cone.along / size;
    let climb = dot(rod.along, unit);
    let beside = rod.along - climb * unit;
    let q = dot(beside, beside);
    let t = climb * (cone.end - cone.start) / size;
    let margin = q - t * t;
    if (q <= 1e-8 * aa) | (margin <= 0.0) {
        return -1.0;
    }
    let start = to_axis - dot(to_axis, unit) * unit;
    let middle = -dot(beside, start) / q;
    return middle + t * length(start + middle * beside) / sqrt(q * margin);
}

// Contact of an axis with a cone or ball from outside. `is_signed`: also where they are apart, and where the ends of the axis touch it.
fn touch_axis_round(rod: Axis, face: Polygon, is_signed: bool) -> Touch {
    let at = lowest_on(rod, face);
    if !unit_interval(at) {
        return no_touch();
    }
    let place = rod.start + at * rod.along - face.corner;
    if face.surface == SURFACE_CONE {
        if !unit_interval(parameter_on(meridian_of(face, Fine(place, vec3f(0.0))))) {
            return no_touch();
        }
    }
    var found = no_touch();
    var ends = 0u;
    // The last one is the contact. It is part of the loop so that compilers make one copy of `touch_round`.
    for (var k = select(0u, 2u, is_signed); k < 3u; k++) {
        found = touch_round(rod.radius, face, Fine(select(rod.start + f32(k) * rod.along - face.corner, place, k == 2u), vec3f(0.0)));
        ends += u32((k < 2u) & (found.overlap > 0.0));
    }
    found.a = at;
    if ends == 2u {
        return no_touch();
    }
    return found;
}

// Contact of a rod with a feature of a polygon. `is_signed`: also where they are apart, and where the end spheres carry the rod.
fn touch_axis(rod: Axis, face: Polygon, feature: u32, is_signed: bool) -> AxisTouch {
    if is_round(face) {
        return AxisTouch(touch_axis_round(rod, face, is_signed), false);
    }
    let rim = rim_of(face, feature);
    let found = touch_axis_rim(rod, face, rim);
    if is_signed | !(found.touch.overlap > 0.0) {
        return found;
    }
    let one = distance(nearest_on_rim(rim, rod.start), rod.start);
    let end = rod.start + rod.along;
    if max(one, distance(nearest_on_rim(rim, end), end)) < rod.radius {
        return no_axis_touch();
    }
    return found;
}
