// Springs and tethers: a wire coiled around the line between the ends. The number of turns does not depend on the length. Far
// away, where the turns could not be told apart, the coil becomes a thin line. The wire is the half of a tube that faces the viewer,
// and its vertices are lit, not its pixels: a wire is so thin that software devices would spend most of a frame on the shadows of
// its pixels.

struct CoilVertex {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

const TURNS: f32 = 6.0;
const TURN: f32 = 6.2831853;
/// Least radius of a wire, and radius of the line that a far coil becomes, in pixels.
const WIRE: f32 = 0.6;
const LINE: f32 = 0.45;
/// Distance between two turns, and radius of the turns, between which a coil becomes a line, in pixels.
const PITCH: vec2f = vec2f(3.0, 5.0);
const TURN_RADIUS: vec2f = vec2f(1.5, 3.0);

/// Part of the angle between the rims of the half tube that its normals have, so that the middle is lit between few vertices.
const ROUND: f32 = 0.8;
/// Number of samples of the shadow filter per vertex.
const COIL_TAPS: u32 = 4u;

/// A coil from one surface to the other.
struct Coil {
    start: vec3f,
    line: vec3f,
    /// Radius of the turns.
    radius: f32,
    /// Radius of the wire.
    wire: f32,
}

fn coil_between(end1: vec4f, end2: vec4f, rest: f32) -> Coil {
    let apart = end2.xyz - end1.xyz;
    let distance = length(apart);
    // The coil begins a little inside each sphere, so that no gap is visible.
    let sunk = 0.96 * vec2f(end1.w, end2.w);
    let long = distance - sunk.x - sunk.y;
    var coil: Coil;
    if long <= 0.0 || distance <= 1e-20 {
        return coil;
    }
    let axis = apart / distance;
    coil.start = end1.xyz + sunk.x * axis;
    coil.line = long * axis;
    let least = select(min(end1.w, end2.w), max(end1.w, end2.w), min(end1.w, end2.w) == 0.0);
    let room = max(rest - sunk.x - sunk.y, 0.25 * long);
    // Of many springs between a few balls, the turns are narrower, so that a lattice is seen and not a tangle.
    let crowd = clamp(1.5 * f32(frame.spheres) / f32(max(frame.springs, 1u)), 0.3, 1.0);
    coil.radius = min(0.36 * crowd * least, 0.5 * room);
    // Thin enough that the turns of a spring at rest do not touch.
    coil.wire = min(0.18 * coil.radius, 0.17 * room / TURNS);
    return coil;
}

/// Returns how much of the radius of the turns is shown, from 0 for a line to 1. `pixel` is the width of a pixel.
fn coiled_part(coil: Coil, pixel: f32) -> f32 {
    let pitch = length(coil.line) / TURNS;
    return smoothstep(PITCH.x, PITCH.y, pitch / pixel) * smoothstep(TURN_RADIUS.x, TURN_RADIUS.y, coil.radius / pixel);
}

/// `viewer` is the point (w = 1) or the direction (w = 0) from which the half tube is seen.
fn coil_vertex(coil: Coil, index: u32, colour: vec3f, viewer: vec4f) -> CoilVertex {
    var vertex: CoilVertex;
    vertex.place = NOWHERE;
    if coil.radius == 0.0 {
        return vertex;
    }
    let part = f32(index / frame.coil_sides) / f32(frame.coil_segments);
    let angle = TURN * TURNS * part;
    let axis = normalize(coil.line);
    let u = aside_of(axis);
    let v = cross(axis, u);
    let outwards = cos(angle) * u + sin(angle) * v;
    let around = cos(angle) * v - sin(angle) * u;
    let pixel = pixel_width() * max(dot(coil.start + 0.5 * coil.line - frame.eye, frame.forward), 0.0);
    let coiled = coiled_part(coil, pixel);
    // The wire begins and ends on the axis.
    let radius = coiled * coil.radius * smoothstep(0.0, 0.08, part) * smoothstep(1.0, 0.92, part);
    let along = normalize(coil.line + TURN * TURNS * radius * around);
    let middle = coil.start + part * coil.line + radius * outwards;
    let beside = cross(along, viewer.xyz - viewer.w * middle);
    let across = select(outwards, normalize(beside), dot(beside, beside) > 0.0);
    let towards = cross(across, along);
    let side = TURN * (0.5 * f32(index % frame.coil_sides) / f32(frame.coil_sides - 1u) - 0.25);
    vertex.normal = cos(ROUND * side) * towards + sin(ROUND * side) * across;
    // Wide enough that the wire stays visible.
    let wire = mix(LINE * pixel, max(coil.wire, WIRE * pixel), coiled);
    vertex.point = middle + wire * (cos(side) * towards + sin(side) * across);
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    vertex.colour = colour;
    return vertex;
}

@vertex
fn spring_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) spring: u32) -> CoilVertex {
    return lit_coil(spring_corner(index, spring, vec4f(frame.eye, 1.0)));
}

fn spring_corner(index: u32, spring: u32, viewer: vec4f) -> CoilVertex {
    let at = frame.springs_at + 5u * spring;
    let end = ball(topology[at]);
    let coil = coil_between(end, ball_beside(topology[at + 1u], end.xyz), topology_float(at + 3u));
    return coil_vertex(coil, index, object_colour(KIND_SPRING, spring), viewer);
}

@vertex
fn tether_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) tether: u32) -> CoilVertex {
    return lit_coil(tether_corner(index, tether, vec4f(frame.eye, 1.0)));
}

fn tether_corner(index: u32, tether: u32, viewer: vec4f) -> CoilVertex {
    let at = frame.tethers_at + 7u * tether;
    let coil = coil_between(ball(topology[at]), vec4f(topology_vector(at + 1u), 0.0), topology_float(at + 5u));
    return coil_vertex(coil, index, tether_colour(tether), viewer);
}

fn lit_coil(corner: CoilVertex) -> CoilVertex {
    var vertex = corner;
    if any(vertex.place != NOWHERE) {
        vertex.colour = lit_roughly(vertex.colour, vertex.point, vertex.normal, normalize(frame.eye - vertex.point), GLOSS, COIL_TAPS);
    }
    return vertex;
}

@fragment
fn coil_surface(vertex: CoilVertex) -> @location(0) vec4f {
    return vec4f(vertex.colour, 1.0);
}
