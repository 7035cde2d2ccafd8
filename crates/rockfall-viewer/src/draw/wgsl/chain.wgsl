// Force chains: a ribbon between the two bodies of every contact, over everything else.

struct ChainVertex {
    @builtin(position) place: vec4f,
    /// Position across the ribbon, from -1 to 1.
    @location(0) across: f32,
    @location(1) @interpolate(flat) colour: vec3f,
}

/// Half width of the ribbon of the greatest force of the scale, divided by the typical radius.
const THICKEST: f32 = 0.42;
/// Least half width, in pixels.
const THINNEST: f32 = 0.7;
/// Slot of an end that is not the centre of a sphere.
const NO_SLOT: u32 = 0xffffffffu;

/// The first end is in the box of a periodic scene, the other one beside it.
fn chain_ends(slots: vec2u, point1: vec3f, point2: vec3f) -> array<vec3f, 2> {
    var ends = array<vec3f, 2>(point1, point2);
    if slots.x != NO_SLOT {
        ends[0] = ball(slots.x).xyz;
    }
    if slots.y != NO_SLOT {
        ends[1] = ball_beside(slots.y, ends[0]).xyz;
    }
    return ends;
}

@vertex
fn chain_vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) slots: vec2u,
    @location(1) point1: vec3f,
    @location(2) point2: vec3f,
    @location(3) force: f32,
) -> ChainVertex {
    let ends = chain_ends(slots, point1, point2);
    let end1 = ends[0];
    let end2 = ends[1];
    let side = vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0;
    let middle = select(end1, end2, side.y > 0.0);
    let aside = cross(end2 - end1, middle - frame.eye);
    let part = clamp(force / max(frame.range.y, 1e-30), 0.0, 1.0);
    let pixel = pixel_width() * dot(middle - frame.eye, frame.forward);
    let half = max(THICKEST * frame.typical_radius * part, THINNEST * pixel);
    var vertex: ChainVertex;
    vertex.place = NOWHERE;
    if pixel <= 0.0 || dot(aside, aside) <= 0.0 {
        return vertex;
    }
    vertex.place = frame.view_projection * vec4f(middle + side.x * half * normalize(aside), 1.0);
    vertex.across = side.x;
    vertex.colour = scale_colour(force);
    return vertex;
}

@fragment
fn chain_surface(vertex: ChainVertex) -> @location(0) vec4f {
    // Darker towards the edges, like a cylinder, so that light colours stand out from the bodies.
    let round = sqrt(max(1.0 - vertex.across * vertex.across, 0.0));
    return vec4f(vertex.colour * mix(0.25, 1.0, round), 1.0);
}
