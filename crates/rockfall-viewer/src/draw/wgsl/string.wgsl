// Distance joints: a cylinder between the anchors, of which only the half that faces the viewer is drawn.

struct StringVertex {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    /// Position across the string, from -1 to 1.
    @location(1) across: f32,
    /// Directions across the string and towards the viewer.
    @location(2) aside: vec3f,
    @location(3) towards: vec3f,
}

/// Radius of a string, divided by the typical radius of bodies.
const STRING_RADIUS: f32 = 0.05;
/// Least radius, in pixels.
const THINNEST_STRING: f32 = 0.7;

/// `viewer` is the point (w = 1) or the direction (w = 0) from which the string is seen.
fn string_corner(corner: u32, start: vec3f, end: vec3f, viewer: vec4f) -> StringVertex {
    let side = vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0;
    let middle = select(start, end, side.y > 0.0);
    let view = viewer.xyz - viewer.w * middle;
    let aside = cross(end - start, view);
    let pixel = pixel_width() * dot(middle - frame.eye, frame.forward);
    var vertex: StringVertex;
    vertex.place = NOWHERE;
    if dot(aside, aside) <= 0.0 {
        return vertex;
    }
    vertex.across = side.x;
    vertex.aside = normalize(aside);
    vertex.towards = normalize(cross(vertex.aside, end - start));
    vertex.point = middle + side.x * max(STRING_RADIUS * frame.typical_radius, THINNEST_STRING * max(pixel, 0.0)) * vertex.aside;
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    return vertex;
}

@vertex
fn string_vertex(@builtin(vertex_index) corner: u32, @location(0) start: vec3f, @location(1) end: vec3f) -> StringVertex {
    return string_corner(corner, start, end, vec4f(frame.eye, 1.0));
}

@fragment
fn string_surface(vertex: StringVertex) -> @location(0) vec4f {
    let view = normalize(frame.eye - vertex.point);
    let towards = normalize(vertex.towards) * sign(dot(vertex.towards, view));
    let normal = normalize(vertex.across * vertex.aside + sqrt(max(1.0 - vertex.across * vertex.across, 0.0)) * towards);
    return vec4f(lit_roughly(frame.kinds[KIND_TETHER].rgb, vertex.point, normal, view, GLOSS, COIL_TAPS), 1.0);
}
