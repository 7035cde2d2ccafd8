// Boxes and polygons.

struct FlatVertex {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
    /// Position on the face relative to a corner, in units.
    @location(2) on_face: vec2f,
    @location(3) @interpolate(flat) sides: vec2f,
    @location(4) @interpolate(flat) colour: vec3f,
    /// Brightness of the rim. Triangles have none, because a mesh would be full of lines.
    @location(5) @interpolate(flat) rim: f32,
}

/// Brightness of the side of a polygon that bodies can pass through.
const BACK: f32 = 0.85;
/// Distance by which polygons are enlarged on all sides, in pixels. It closes the gaps between polygons whose corners differ by
/// rounding, through which single samples would show the background.
const OVERLAP: f32 = 0.35;

fn quad_corner(index: u32) -> vec2f {
    // Two triangles.
    let order = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u);
    let corner = order[index];
    return vec2f(vec2u(corner & 1u, corner >> 1u));
}

fn face(corner: vec3f, first: vec3f, second: vec3f, normal: vec3f, index: u32) -> FlatVertex {
    let on = quad_corner(index);
    var vertex: FlatVertex;
    vertex.point = corner + on.x * first + on.y * second;
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    vertex.normal = normal;
    vertex.sides = vec2f(length(first), length(second));
    vertex.on_face = on * vertex.sides;
    vertex.rim = 1.0;
    return vertex;
}

@vertex
fn box_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = box_corner(index, number);
    if drawn[number] == 0u {
        vertex.place = NOWHERE;
    }
    return vertex;
}

/// Of boxes that hide bodies, only the edges are drawn.
@vertex
fn box_edges_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = box_corner(index, number);
    if drawn[number] != 0u {
        vertex.place = NOWHERE;
    }
    return vertex;
}

fn box_corner(index: u32, number: u32) -> FlatVertex {
    let at = frame.boxes_at + 12u * number;
    let edges = array<vec3f, 3>(topology_vector(at + 3u), topology_vector(at + 6u), topology_vector(at + 9u));
    let axis = index / 12u;
    let far = index / 6u % 2u == 1u;
    let through = edges[axis];
    let corner = topology_vector(at) + select(vec3f(0.0), through, far);
    let normal = normalize(select(-through, through, far));
    var vertex = face(corner, edges[(axis + 1u) % 3u], edges[(axis + 2u) % 3u], normal, index % 6u);
    vertex.colour = object_colour(KIND_BOX, number);
    return vertex;
}

@vertex
fn polygon_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = polygon_corner(index, number);
    if polygon_drawn(number) != 1u {
        vertex.place = NOWHERE;
    }
    return vertex;
}

@vertex
fn polygon_edges_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = polygon_corner(index, number);
    if polygon_drawn(number) == 1u {
        vertex.place = NOWHERE;
    }
    return vertex;
}

fn polygon_corner(index: u32, number: u32) -> FlatVertex {
    let at = frame.polygons_at + 10u * number;
    let left = topology_vector(at + 3u);
    let right = topology_vector(at + 6u);
    let is_triangle = topology[at + 9u] != 0u;
    // The second half of a quad is not drawn for a triangle: its corners are in one place.
    let shown = select(index, min(index, 2u), is_triangle);
    var vertex = face(topology_vector(at), left, right, normalize(cross(left, right)), shown);
    vertex.rim = select(1.0, 0.0, is_triangle);
    let pixel = pixel_width() * max(dot(vertex.point - frame.eye, frame.forward), 0.0);
    let more = OVERLAP * pixel * (2.0 * quad_corner(shown) - 1.0);
    vertex.on_face += more;
    vertex.point += more.x / vertex.sides.x * left + more.y / vertex.sides.y * right;
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    vertex.colour = object_colour(KIND_POLYGON, number);
    return vertex;
}

/// Returns the coverage, from 0 to 1, of a line with half width `half` at this distance from its centre, smoothed over a
/// pixel of `width`.
fn line_at(distance: f32, half: f32, width: f32) -> f32 {
    // A line that is thinner than a pixel is drawn one pixel wide but fainter.
    let shown = max(half, 0.5 * width);
    return (1.0 - smoothstep(shown - 0.5 * width, shown + 0.5 * width, abs(distance))) * min(half / (0.5 * width), 1.0);
}

/// Returns the coverage of the lines of a square grid.
fn lines_at(place: vec2f, width: vec2f, cell: f32, half: f32) -> f32 {
    let away = abs(fract(place / cell - 0.5) - 0.5) * cell;
    let lines = vec2f(line_at(away.x, half, width.x), line_at(away.y, half, width.y));
    let apart = vec2f(1.0) - smoothstep(vec2f(0.15), vec2f(0.5), width / cell);
    return max(lines.x * apart.x, lines.y * apart.y);
}

/// Returns the darkness of the grid: fine lines that fade as the camera moves away, and coarse lines that replace them.
fn grid_at(place: vec2f, width: vec2f) -> f32 {
    let half = frame.cell * mix(0.01, 0.05, frame.cell_fade);
    let fine = lines_at(place, width, frame.cell, half) * (1.0 - frame.cell_fade);
    return max(0.6 * fine, lines_at(place, width, 10.0 * frame.cell, half));
}

/// Returns the coverage of the rim of a face.
fn rim_at(vertex: FlatVertex, width: vec2f) -> f32 {
    let away = min(vertex.on_face, vertex.sides - vertex.on_face);
    return max(line_at(away.x, 0.75 * width.x, width.x), line_at(away.y, 0.75 * width.y, width.y));
}

@fragment
fn box_surface(vertex: FlatVertex) -> @location(0) vec4f {
    let width = fwidth(vertex.on_face);
    let view = normalize(frame.eye - vertex.point);
    let lines = 0.14 * grid_at(vertex.on_face, width);
    let colour = vertex.colour * (1.0 - lines - 0.25 * rim_at(vertex, width));
    return vec4f(lit(colour, vertex.point, vertex.normal, view), 1.0);
}

@fragment
fn edges_surface(vertex: FlatVertex) -> @location(0) vec4f {
    let opacity = 0.45 * rim_at(vertex, fwidth(vertex.on_face));
    return vec4f(vec3f(0.16, 0.18, 0.21), 1.0) * opacity;
}

@fragment
fn polygon_surface(vertex: FlatVertex) -> @location(0) vec4f {
    let width = fwidth(vertex.on_face);
    let view = normalize(frame.eye - vertex.point);
    let is_front = dot(vertex.normal, view) > 0.0;
    // Both sides of a triangle can be touched.
    let brightness = select(BACK, 1.0, is_front | (vertex.rim == 0.0));
    let colour = vertex.colour * brightness * (1.0 - 0.35 * vertex.rim * rim_at(vertex, width));
    return vec4f(lit(colour, vertex.point, select(-vertex.normal, vertex.normal, is_front), view), 1.0);
}
