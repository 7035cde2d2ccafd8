// Rods and capsules, which are all points within a radius of a line segment: ray-cast in a box around them.

struct CapsuleVertex {
    @builtin(position) place: vec4f,
    @location(0) @interpolate(flat) end1: vec4f,
    @location(1) @interpolate(flat) end2: vec3f,
    @location(2) @interpolate(flat) orientation: vec4f,
    @location(3) @interpolate(flat) colour1: vec3f,
    @location(4) @interpolate(flat) colour2: vec3f,
    @location(5) @interpolate(flat) whole: u32,
    @location(6) @interpolate(flat) look: u32,
    @location(7) @interpolate(flat) offset: vec3f,
}

/// Returns a corner of the cube from -1 to 1, in the order of a triangle strip of 14 vertices.
fn cube_corner(index: u32) -> vec3f {
    let bits = (vec3u(0x287au, 0x02afu, 0x31e3u) >> vec3u(index)) & vec3u(1u);
    return vec3f(bits) * 2.0 - 1.0;
}

/// Returns a corner of a box that contains a capsule with a margin.
fn capsule_corner(end1: vec3f, end2: vec3f, radius: f32, margin: f32, index: u32) -> vec3f {
    let line = end2 - end1;
    let long = length(line);
    let axis = select(vec3f(0.0, 1.0, 0.0), line / long, long > 1e-20);
    let u = aside_of(axis);
    let corner = cube_corner(index);
    let reach = radius + margin;
    return 0.5 * (end1 + end2) + reach * (corner.x * u + corner.y * cross(axis, u)) + (0.5 * long + reach) * corner.z * axis;
}

@vertex
fn capsule_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) rod: u32) -> CapsuleVertex {
    return capsule_of(corner, rod, false);
}

/// Rods and capsules of glass are drawn after all other bodies.
@vertex
fn glass_capsule_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) rod: u32) -> CapsuleVertex {
    return capsule_of(corner, rod, true);
}

fn capsule_of(corner: u32, rod: u32, of_glass: bool) -> CapsuleVertex {
    let at = frame.rods_at + 4u * rod;
    let slots = vec2u(topology[at], topology[at + 1u]);
    let end1 = ball(slots.x).xyz;
    let end2 = ball_beside(slots.y, end1).xyz;
    let radius = topology_float(at + 2u);
    let margin = pixel_width() * (length(0.5 * (end1 + end2) - frame.eye) + length(end2 - end1));
    var vertex: CapsuleVertex;
    vertex.look = body_look(frame.spheres + rod);
    if (vertex.look == LOOK_GLASS) != of_glass {
        vertex.place = NOWHERE;
        return vertex;
    }
    vertex.offset = pattern_offset(rod);
    vertex.place = frame.view_projection * vec4f(capsule_corner(end1, end2, radius, margin, corner), 1.0);
    vertex.end1 = vec4f(end1, radius);
    vertex.end2 = end2;
    vertex.orientation = orientation(slots.x);
    vertex.whole = select(0u, 1u, is_capsule(rod));
    if is_on_scale() {
        vertex.colour1 = scale_colour(value_of(slots.x));
        vertex.colour2 = scale_colour(value_of(slots.y));
    } else if vertex.whole == 1u && (frame.colour_by != BY_KIND || own_colour(slots.x).a > 0.0) {
        // A capsule is one body, with the colour of its first end.
        vertex.colour1 = sphere_colour(slots.x);
        vertex.colour2 = vertex.colour1;
    } else if is_pale() {
        vertex.colour1 = PALE;
        vertex.colour2 = PALE;
    } else {
        let own = colour_at(frame.spheres + rod);
        let kind = select(KIND_ROD, KIND_CAPSULE, vertex.whole == 1u);
        vertex.colour1 = select(frame.kinds[kind].rgb * (0.9 + 0.2 * hash(rod)), own.rgb, own.a > 0.0);
        vertex.colour2 = vertex.colour1;
    }
    return vertex;
}

/// The nearest points of a ray and a line segment: the position on the segment from 0 to 1, the position on the ray, and the
/// squared distance.
struct Nearest {
on_line: f32,
on_ray: f32,
square: f32,
}

fn nearest_points(offset: vec3f, line: vec3f, ray: vec3f) -> Nearest {
    // The components perpendicular to the ray.
    let from_ray = offset - dot(offset, ray) * ray;
    let across = line - dot(line, ray) * ray;
    let on_line = clamp(-dot(from_ray, across) / max(dot(across, across), 1e-30), 0.0, 1.0);
    let nearest = from_ray + on_line * across;
    return Nearest(on_line, dot(offset + on_line * line, ray), dot(nearest, nearest));
}

/// Returns the position on a ray of its intersection with a capsule (after Quilez, "capsule - intersection"). `found` has the
/// nearest points of the ray and the axis, which are closer than the radius.
fn intersect_capsule(offset: vec3f, line: vec3f, radius: f32, ray: vec3f, found: Nearest) -> f32 {
// Relative to the point of the ray that is nearest to the axis, which keeps rounding errors small.
    let start = found.on_ray * ray - offset;
    let square = dot(line, line);
    let along_ray = dot(line, ray);
    let along = dot(line, start);
    let a = square - along_ray * along_ray;
    let b = square * dot(ray, start) - along * along_ray;
    let c = square * dot(start, start) - along * along - radius * radius * square;
    let root = b * b - a * c;
    if root >= 0.0 && a > 1e-6 * square {
        let distance = (-b - sqrt(root)) / a;
        let on_line = along + distance * along_ray;
        if on_line > 0.0 && on_line < square {
            return found.on_ray + distance;
        }
    }
    let first = intersect_ball(start, ray, radius);
    let second = intersect_ball(start - line, ray, radius);
    return found.on_ray + min(first, second);
}

fn intersect_ball(start: vec3f, ray: vec3f, radius: f32) -> f32 {
    let b = dot(start, ray);
    let aside = start - b * ray;
    let root = radius * radius - dot(aside, aside);
    return select(1e30, -b - sqrt(max(root, 0.0)), root >= 0.0);
}

/// Returns the place of a point of a capsule in the pattern of its look, whose unit is the radius. A rod has no orientation, so
/// its pattern depends on the place along its axis alone. The grain is along the axis.
fn capsule_pattern(vertex: CapsuleVertex, axis: vec3f, normal: vec3f, along: f32) -> vec3f {
    if vertex.whole == 0u {
        return vec3f(1.0, along, 0.0) + vertex.offset;
    }
    let pole = to_body(vertex.orientation, axis);
    let u = aside_of(pole);
    let n = to_body(vertex.orientation, normal);
    return vec3f(dot(n, u), along + dot(n, pole), dot(n, cross(pole, u))) + vertex.offset;
}

/// Returns the weight of the second tone: each half of the capsule has four sectors around the axis in alternating tones, and
/// the tones are swapped in the middle.
fn capsule_tone(orientation: vec4f, axis: vec3f, normal: vec3f, middle: f32, width: f32) -> f32 {
    let pole = to_body(orientation, axis);
    let u = aside_of(pole);
    let n = to_body(orientation, normal);
    let around = vec2f(dot(n, u), dot(n, cross(pole, u)));
    let stripes = smoothstep(-width, width, around.x * around.y / max(length(around), 1e-3));
    let flipped = smoothstep(-width, width, middle);
    return mix(mix(stripes, 1.0 - stripes, flipped), 0.5, smoothstep(0.1, 0.5, width));
}

@fragment
fn capsule_surface(vertex: CapsuleVertex) -> Surface {
    let radius = vertex.end1.w;
    let offset = vertex.end1.xyz - frame.eye;
    let line = vertex.end2 - vertex.end1.xyz;
    var surface: Surface;
    for (var index = 0u; index < 4u; index++) {
        let ray = normalize(view_ray(vertex.place.xy + sample_place(index)));
        if nearest_points(offset, line, ray).square <= radius * radius {
            surface.covered |= 1u << index;
        }
    }
    if surface.covered == 0u {
        discard;
    }
    let ray = normalize(view_ray(vertex.place.xy));
    let found = nearest_points(offset, line, ray);
    var distance = found.on_ray;
    if found.square < radius * radius {
        distance = intersect_capsule(offset, line, radius, ray, found);
    }
    let point = frame.eye + distance * ray;
    let on_line = clamp(dot(point - vertex.end1.xyz, line) / max(dot(line, line), 1e-30), 0.0, 1.0);
    let normal = normalize(point - vertex.end1.xyz - on_line * line);
    var colour = mix(vertex.colour1, vertex.colour2, on_line);
    let width = distance * pixel_width() / (radius * max(-dot(normal, ray), 0.15));
    let long = max(length(line), 1e-20);
    if vertex.look == LOOK_GLASS {
        surface.colour = glass(colour, normal, -ray, glass_rim(normal, ray));
        surface.depth = depth_at(point);
        return surface;
    } else if vertex.whole == 1u && vertex.look <= LOOK_STRIPED && vertex.look != LOOK_PLAIN {
        let middle = (on_line - 0.5) * long / radius;
        colour = mix(colour, second_tone(colour), capsule_tone(vertex.orientation, line / long, normal, middle, width));
    } else if vertex.look == LOOK_STRIPED {
        colour = mix(colour, second_tone(colour), stripes(0.5 * on_line * long / radius, 0.5 * width));
    } else if vertex.look >= LOOK_WOOD {
        let place = capsule_pattern(vertex, line / long, normal, on_line * long / radius);
        colour *= shade_of(vertex.look, place, width);
    }
    surface.colour = vec4f(lit(colour, point, normal, -ray, gloss_of(vertex.look)), 1.0);
    surface.depth = depth_at(point);
    return surface;
}
