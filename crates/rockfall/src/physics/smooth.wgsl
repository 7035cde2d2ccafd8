// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl physics/round_pair.wgsl

// Planes, cones, cylinders and balls that bodies touch (docs/physics section 2.17).

fn is_plane(face: Polygon) -> bool {
    return SMOOTH && (face.surface == SURFACE_PLANE);
}

// Whether a polygon is a cone, a cylinder or a ball.
fn is_round(face: Polygon) -> bool {
    return SMOOTH && (face.surface >= SURFACE_CONE);
}

// The axis of a cone, which begins at its corner.
struct ConeAxis {
    along: vec3f,
    // Unit vector in the direction of R.
    out: vec3f,
    // Radii at the start and at the end.
    start: f32,
    end: f32,
}

fn axis_of(face: Polygon) -> ConeAxis {
    let start = length(face.right);
    let out = face.right / start;
    let slope = dot(face.left, out);
    return ConeAxis(face.left - slope * out, out, start, start + slope);
}

// 1 for a surface that is touched from outside, -1 from inside.
fn side_of_round(face: Polygon) -> f32 {
    return select(1.0, -1.0, (face.surface == SURFACE_CONE + 1u) | (face.surface == SURFACE_BALL + 1u));
}

// The length of a vector, and what is left beyond its digits.
fn fine_length(v: Fine) -> vec2f {
    let size = length(v.high);
    if DOUBLE {
        return vec2f(size, select(0.0, length_beyond(v, size), size > 0.0));
    }
    return vec2f(size, 0.0);
}

// A point as it is seen from a cone, in the half-plane through the axis that contains it: the coordinates are the distance from the axis and
// the way along it.
struct Meridian {
    // Unit vectors of the coordinates.
    out: vec3f,
    along: vec3f,
    // The point, from the start of the segment that is turned.
    place: vec2f,
    segment: vec2f,
    // Unit normal of the segment, away from the axis.
    normal: vec2f,
    // Distance of the point from the line through the segment along the normal, in front of it.
    height: f32,
    // What is left of the height beyond its digits.
    low: f32,
}

// `t` leads from the start of the axis to the point.
fn meridian_of(face: Polygon, t: Fine) -> Meridian {
    let axis = axis_of(face);
    let squared = dot(axis.along, axis.along);
    let size = sqrt(squared);
    let along = axis.along / size;
    let share = dot(t.high, axis.along) / squared;
    var across = Fine(t.high - share * axis.along, vec3f(0.0));
    if DOUBLE {
        across = fine_sum(t, product_of(vec3f(-share), axis.along));
    }
    // What the rounding of the share leaves along the axis.
    let rest = dot(across.high, along);
    if DOUBLE {
        across = fine_moved(across, -rest * along);
    } else {
        across.high -= rest * along;
    }
    let distance = fine_length(across);
    let out = select(axis.out, across.high / distance.x, distance.x > 0.0);
    let segment = vec2f(axis.end - axis.start, size);
    let normal = vec2f(size, -segment.x) / length(segment);
    let way = share * size + rest;
    let place = vec2f(distance.x - axis.start, way);
    var meridian = Meridian(out, along, place, segment, normal, dot(place, normal), 0.0);
    if DOUBLE {
        let beyond = distance.y - fine_length(Fine(face.right, vec3f(0.0))).y;
        let from_axis = product_of(vec3f(place.x), vec3f(normal.x));
        let steps = product_of(vec3f(share), vec3f(size));
        let from_start = product_of(steps.high, vec3f(normal.y));
        let sum = sum_of(from_axis.high, from_start.high);
        let lows = from_axis.low.x + from_start.low.x + sum.low.x;
        meridian.height = sum.high.x;
        meridian.low = lows + beyond * normal.x + (steps.low.x + rest) * normal.y;
    }
    return meridian;
}

fn in_space(meridian: Meridian, v: vec2f) -> vec3f {
    return v.x * meridian.out + v.y * meridian.along;
}

// Parameter of the point of the line through the segment that is nearest to the point.
fn parameter_on(meridian: Meridian) -> f32 {
    return dot(meridian.place, meridian.segment) / dot(meridian.segment, meridian.segment);
}

// The vector to the nearest point of the segment.
fn to_segment(meridian: Meridian) -> vec2f {
    return clamp(parameter_on(meridian), 0.0, 1.0) * meridian.segment - meridian.place;
}

// Contact of a sphere with a cone or ball. `t` leads from the corner to the centre.
fn touch_round(radius: f32, face: Polygon, t: Fine) -> Touch {
    let side = side_of_round(face);
    if face.surface >= SURFACE_BALL {
        let distance = fine_length(t);
        let size = fine_length(Fine(face.left, vec3f(0.0)));
        let height = side * (distance.x - size.x);
        if !(height >= 0.0) {
            return no_touch();
        }
        let out = select(vec3f(0.0, 1.0, 0.0), t.high / distance.x, distance.x > 0.0);
        return Touch(-side * out, radius - height - side * (distance.y - size.y), 0.0, 0.0);
    }
    let meridian = meridian_of(face, t);
    let height = side * meridian.height;
    if !(height >= 0.0) {
        return no_touch();
    }
    let n = in_space(meridian, -side * meridian.normal);
    if unit_interval(parameter_on(meridian)) {
        return Touch(n, radius - height - side * meridian.low, 0.0, 0.0);
    }
    let squared = max(dot(face.left, face.left), dot(face.right, face.right));
    let to_rim = unrounded(in_space(meridian, to_segment(meridian)), squared, radius);
    return touch_at(to_rim, radius, 0.0, 0.0, n);
}

// The least product of a unit vector with the vector from a place to a point of a smooth wall, -3e38 if there is none (docs/physics
// section 2.11).
fn front_of_smooth(face: Polygon, place: vec3f, n: vec3f, one_normal: f32) -> f32 {
    let to_corner = face.corner - place;
    if face.surface == SURFACE_PLANE {
        let normal = normalize(cross(face.left, face.right));
        return select(-3e38, dot(to_corner, n), abs(dot(normal, n)) >= one_normal);
    }
    if face.surface >= SURFACE_BALL {
        return dot(to_corner, n) - length(face.left);
    }
    let axis = axis_of(face);
    let rise = dot(axis.along, n) / length(axis.along);
    let reach = sqrt(max(0.0, 1.0 - rise * rise));
    return min(dot(to_corner, n) - axis.start * reach, dot(to_corner + axis.along, n) - axis.end * reach);
}

// From the corner of a smooth wall to its middle, from which the nearest image counts.
fn middle_of_smooth(face: Polygon) -> vec3f {
    return select(vec3f(0.0), 0.5 * axis_of(face).along, (face.surface >= SURFACE_CONE) & (face.surface < SURFACE_BALL));
}

// The least and the greatest coordinates of a smooth wall, from its corner. Those of a plane are its corner.
struct SmoothBounds {
    least: vec3f,
    most: vec3f,
}

fn bounds_of_smooth(face: Polygon) -> SmoothBounds {
    if face.surface == SURFACE_PLANE {
        return SmoothBounds(vec3f(0.0), vec3f(0.0));
    }
    if face.surface >= SURFACE_BALL {
        let size = vec3f(length(face.left));
        return SmoothBounds(-size, size);
    }
    let axis = axis_of(face);
    let unit = axis.along / length(axis.along);
    let reach = sqrt(max(vec3f(0.0), vec3f(1.0) - unit * unit));
    let start = axis.start * reach;
    let end = axis.end * reach;
    return SmoothBounds(min(-start, axis.along - end), max(start, axis.along + end));
}
