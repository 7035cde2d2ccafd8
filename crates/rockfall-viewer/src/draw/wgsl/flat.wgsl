// Boxes and polygons.

struct FlatVertex {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
    /// Position on the face relative to a corner, in units.
    @location(2) on_face: vec2f,
    @location(3) @interpolate(flat) sides: vec2f,
    @location(4) @interpolate(flat) colour: vec3f,
    @location(5) @interpolate(flat) look: u32,
    /// Place in the pattern of the look, whose y axis is along the longest edge, and the number of stripes up to it.
    @location(6) local: vec4f,
    /// Brightness of the rim. Triangles have none, because a mesh would be full of lines.
    @location(7) @interpolate(flat) rim: f32,
    /// Length that the pattern is measured in, in units.
    @location(8) @interpolate(flat) unit: f32,
}

/// Brightness of the side of a polygon that bodies can pass through.
const BACK: f32 = 0.85;
/// Distance by which polygons are enlarged on all sides, in pixels. It closes the gaps between polygons whose corners differ by
/// rounding, through which single samples would show the background.
const OVERLAP: f32 = 0.35;

/// A box is flat if its least edge divided by its second one is at most this.
const FLAT: f32 = 0.5;

/// Depth of the caps of bodies that a pane of glass covers, in typical radii. A body that touches the pane overlaps it a little.
const CAP: f32 = 0.12;

/// Moves a corner of a pane of glass towards the eye, so that the caps of bodies that overlap the pane are not drawn in front of it,
/// where they would be dark dots.
fn in_front_of_caps(place: vec4f) -> vec4f {
    let nearer = max(place.w - CAP * frame.typical_radius, 0.5 * place.w);
    return vec4f(place.xy, place.z * place.w / max(nearer, 1e-30), place.w);
}

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

/// Returns the place in the pattern of a look: coordinates along the edges with the longest edge as y, in units of `unit`, so that
/// the pattern suits the bodies. `along` is relative to the middle. The fourth one counts stripes: an odd number of them, at least
/// five, that are about as wide as the second longest edge.
fn in_pattern(along: vec3f, longs: vec3f, unit: f32, number: u32) -> vec4f {
    var place = along.zxy;
    if longs.y > longs.x && longs.y >= longs.z {
        place = along;
    } else if longs.z > max(longs.x, longs.y) {
        place = along.yzx;
    }
    let longest = max(longs.x, max(longs.y, longs.z));
    let second = max(min(longs.x, max(longs.y, longs.z)), min(longs.y, longs.z));
    let count = 2.0 * round(clamp(0.5 * longest / second, 2.0, 1000.0)) + 1.0;
    return vec4f(place / unit + pattern_offset(number), (place.y / longest + 0.5) * count);
}

/// Returns the colour of a face with the pattern of its look. `width` is the width of a pixel on it,
/// `stripe` that in stripes.
fn patterned(vertex: FlatVertex, width: vec2f, stripe: f32) -> vec3f {
    let pixel = max(width.x, width.y) / vertex.unit;
    if vertex.look == LOOK_STRIPED {
        return mix(vertex.colour, second_tone(vertex.colour), stripes(vertex.local.w, stripe));
    }
    return vertex.colour * shade_of(vertex.look, vertex.local.xyz, pixel);
}

@vertex
fn box_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = box_corner(index, number);
    if drawn[number] == 0u || vertex.look == LOOK_GLASS {
        vertex.place = NOWHERE;
    }
    return vertex;
}

/// Boxes of glass are drawn after all other bodies.
@vertex
fn glass_box_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = box_corner(index, number);
    vertex.place = in_front_of_caps(vertex.place);
    if vertex.look != LOOK_GLASS {
        vertex.place = NOWHERE;
    }
    return vertex;
}

/// A box that hides bodies is drawn as a pane: the broad face on the side of the bodies, which the eye sees from within the box. A box
/// that is not flat has all faces that are turned away from the eye.
@vertex
fn box_edges_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = box_corner(index, number);
    let edge = frame.boxes_at + 12u * number + 3u;
    let thickness = length(topology_vector(edge + 3u * (index / 12u)));
    let least = min(thickness, min(vertex.sides.x, vertex.sides.y));
    let most = max(thickness, max(vertex.sides.x, vertex.sides.y));
    let second = thickness + vertex.sides.x + vertex.sides.y - least - most;
    let is_broad = thickness == least || least > FLAT * second;
    let is_away = dot(vertex.normal, frame.eye - vertex.point) < 0.0;
    if drawn[number] != 0u || !(is_broad && is_away) {
        vertex.place = NOWHERE;
    }
    return vertex;
}

/// Returns the displacement that takes a wall with this middle to its image in the box of a periodic scene. A middle that is on a face of
/// the box stays there.
fn way_into_box(middle: vec3f) -> vec3f {
    let is_periodic = frame.period > vec3f(0.0);
    let place = (middle - frame.least) / select(vec3f(1.0), frame.period, is_periodic) - 0.5;
    let turns = sign(place) * max(ceil(abs(place) - 0.501), vec3f(0.0));
    return select(vec3f(0.0), -turns * frame.period, is_periodic);
}

fn box_corner(index: u32, number: u32) -> FlatVertex {
    let at = frame.boxes_at + 12u * number;
    let edges = array<vec3f, 3>(topology_vector(at + 3u), topology_vector(at + 6u), topology_vector(at + 9u));
    let base = topology_vector(at);
    let least = base + way_into_box(base + 0.5 * (edges[0] + edges[1] + edges[2]));
    var vertex = corner_between(index, least, edges, frame.typical_radius, number);
    vertex.colour = object_colour(KIND_BOX, number);
    vertex.look = box_look(number);
    return vertex;
}

/// Number of corners of the triangles of the box or hull that a sphere stands for; 0 if it stands for none.
fn block_corners(slot: u32) -> u32 {
    let word = box_word(slot);
    if word == 0u {
        return 0u;
    }
    if (word & HULL_PART) == 0u {
        return 36u;
    }
    return 3u * topology[word & ~HULL_PART];
}

/// Boxes and hulls of rigid bodies. The instances are the spheres; those that stand for one are drawn as it.
@vertex
fn block_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slot: u32) -> FlatVertex {
    return block_of(index, slot, false);
}

@vertex
fn glass_block_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slot: u32) -> FlatVertex {
    return block_of(index, slot, true);
}

fn block_of(index: u32, slot: u32, of_glass: bool) -> FlatVertex {
    if index >= block_corners(slot) || (sphere_look(slot) == LOOK_GLASS) != of_glass {
        var nothing: FlatVertex;
        nothing.place = NOWHERE;
        return nothing;
    }
    return block_corner(index, slot);
}

/// The vector of the scene that a rotation makes of one in the frame of a body.
fn from_body(q: vec4f, v: vec3f) -> vec3f {
    return to_body(vec4f(-q.xyz, q.w), v);
}

/// Share of the width of a face of a hull that is a triangle: the rim is far outside, because a face would have lines across it.
const FACE_OF_HULL: f32 = 0.01;

/// A corner of a triangle of the hull that a sphere stands for.
fn hull_corner(index: u32, slot: u32) -> FlatVertex {
    let triangle = (box_word(slot) & ~HULL_PART) + 1u + 9u * (index / 3u);
    let first = topology_vector(triangle);
    let along = topology_vector(triangle + 3u) - first;
    let normal = normalize(cross(along, topology_vector(triangle + 6u) - first));
    let place = topology_vector(triangle + 3u * (index % 3u));
    let turn = orientation(slot);
    let ball = ball(slot);
    var vertex: FlatVertex;
    vertex.point = ball.xyz + from_body(turn, place);
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    vertex.normal = from_body(turn, normal);
    vertex.sides = vec2f(2.0 * ball.w / FACE_OF_HULL);
    let across = normalize(along);
    vertex.on_face = 0.5 * vertex.sides + vec2f(dot(place, across), dot(place, cross(normal, across)));
    vertex.unit = 0.5 * ball.w;
    vertex.local = in_pattern(place, vec3f(2.0 * ball.w), vertex.unit, insertion_index(slot));
    return vertex;
}

fn block_corner(index: u32, slot: u32) -> FlatVertex {
    var vertex: FlatVertex;
    if (box_word(slot) & HULL_PART) != 0u {
        vertex = hull_corner(index, slot);
    } else {
        vertex = solid_corner(index, slot);
    }
    vertex.colour = sphere_colour(slot);
    let look = sphere_look(slot);
    vertex.look = select(look, LOOK_PLAIN, look == LOOK_USUAL);
    return vertex;
}

fn solid_corner(index: u32, slot: u32) -> FlatVertex {
    let word = box_word(slot);
    let size = 2.0 * topology_vector(word);
    let own = vec4f(topology_vector(word + 3u), topology_float(word + 6u));
    let turn = orientation(slot);
    let edges = array<vec3f, 3>(
        from_body(turn, from_body(own, vec3f(size.x, 0.0, 0.0))),
        from_body(turn, from_body(own, vec3f(0.0, size.y, 0.0))),
        from_body(turn, from_body(own, vec3f(0.0, 0.0, size.z))),
    );
    let least = ball(slot).xyz - 0.5 * (edges[0] + edges[1] + edges[2]);
    let number = insertion_index(slot);
    return corner_between(index, least, edges, 0.5 * min(size.x, min(size.y, size.z)), number);
}

/// A corner of a face of the box between edges that meet at `least`. `unit` is the length that patterns are measured in.
fn corner_between(index: u32, least: vec3f, edges: array<vec3f, 3>, unit: f32, number: u32) -> FlatVertex {
    let axis = index / 12u;
    let far = index / 6u % 2u == 1u;
    var through = edges[0];
    var first = edges[1];
    var second = edges[2];
    if axis == 1u {
        through = edges[1];
        first = edges[2];
        second = edges[0];
    } else if axis == 2u {
        through = edges[2];
        first = edges[0];
        second = edges[1];
    }
    let corner = least + select(vec3f(0.0), through, far);
    let normal = normalize(select(-through, through, far));
    var vertex = face(corner, first, second, normal, index % 6u);
    let place = vertex.point - least;
    let longs = vec3f(length(edges[0]), length(edges[1]), length(edges[2]));
    let along = vec3f(dot(place, edges[0]), dot(place, edges[1]), dot(place, edges[2])) / longs - 0.5 * longs;
    vertex.local = in_pattern(along, longs, unit, number);
    vertex.unit = unit;
    return vertex;
}

@vertex
fn polygon_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = polygon_corner(index, number);
    if polygon_state(index, number) != 1u || vertex.look == LOOK_GLASS {
        vertex.place = NOWHERE;
    }
    return vertex;
}

@vertex
fn glass_polygon_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = polygon_corner(index, number);
    vertex.place = in_front_of_caps(vertex.place);
    if vertex.look != LOOK_GLASS {
        vertex.place = NOWHERE;
    }
    return vertex;
}

@vertex
fn polygon_edges_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatVertex {
    var vertex = polygon_corner(index, number);
    if polygon_state(index, number) == 1u {
        vertex.place = NOWHERE;
    }
    return vertex;
}

/// Surfaces of polygons, as in the physics.
const TRIANGLE: u32 = 1u;
const PLANE: u32 = 2u;
const CONE: u32 = 3u;
const BALL: u32 = 5u;
/// Facets around the axis of a cone or ball, and of a ball along the axis. All together they are FACETS.
const AROUND: u32 = 64u;
const ALONG: u32 = 24u;

/// What is drawn of a polygon, as `polygon_drawn` says, and the facets of a cone or ball by themselves: those of one that is touched from
/// inside are translucent and have no shadow where the camera is outside of it.
fn polygon_state(index: u32, number: u32) -> u32 {
    let surface = topology[frame.polygons_at + 10u * number + 9u];
    if surface < CONE {
        return polygon_drawn(number);
    }
    let middle = round_corner(index - index % 6u, number, vec2f(0.5));
    return select(1u, 0u, is_hollow(number) && dot(frame.eye - middle.point, middle.normal) < 0.0);
}

/// Whether a polygon is a cone or ball that is touched from inside.
fn is_hollow(number: u32) -> bool {
    let surface = topology[frame.polygons_at + 10u * number + 9u];
    return surface == CONE + 1u || surface == BALL + 1u;
}

/// A place on a facet of a cone or ball, from 0 to 1 around the axis and along it. The normal points to the side that is touched.
fn round_corner(index: u32, number: u32, on: vec2f) -> FlatVertex {
    let at = frame.polygons_at + 10u * number;
    let left = topology_vector(at + 3u);
    let right = topology_vector(at + 6u);
    let surface = topology[at + 9u];
    let facet = index / 6u;
    let is_ball = surface >= BALL;
    let turn = TURN * (f32(facet % AROUND) + on.x) / f32(AROUND);
    let middle_turn = TURN * (f32(facet % AROUND) + 0.5) / f32(AROUND);
    let radius = length(right);
    let out = right / radius;
    let slope = dot(left, out);
    let axis = select(left - slope * out, left, is_ball);
    let unit = normalize(axis);
    let beside = cross(unit, out);
    var vertex: FlatVertex;
    let around = cos(turn) * out + sin(turn) * beside;
    let middle = cos(middle_turn) * out + sin(middle_turn) * beside;
    if is_ball {
        let polar = 0.5 * TURN * (f32(facet / AROUND) + on.y) / f32(ALONG);
        let middle_polar = 0.5 * TURN * (f32(facet / AROUND) + 0.5) / f32(ALONG);
        vertex.point = radius * (cos(polar) * unit + sin(polar) * around);
        vertex.normal = cos(middle_polar) * unit + sin(middle_polar) * middle;
    } else {
        vertex.point = on.y * axis + (radius + on.y * slope) * around;
        vertex.normal = normalize(length(axis) * middle - slope * unit);
    }
    let base = topology_vector(at);
    let to_middle = select(0.5 * axis, vec3f(0.0), is_ball);
    vertex.point += base + way_into_box(base + to_middle);
    vertex.normal *= select(1.0, -1.0, is_hollow(number));
    vertex.sides = vec2f(TURN * radius / f32(AROUND), length(left));
    vertex.on_face = vec2f(turn * radius, on.y * length(left));
    return vertex;
}

/// The same as `polygon_corner`, for a cone or ball.
fn corner_of_round(index: u32, number: u32) -> FlatVertex {
    let is_ball = topology[frame.polygons_at + 10u * number + 9u] >= BALL;
    var vertex = round_corner(index, number, quad_corner(index % 6u));
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    if index / 6u >= select(AROUND, AROUND * ALONG, is_ball) {
        vertex.place = NOWHERE;
    }
    vertex.rim = 0.0;
    vertex.colour = object_colour(KIND_POLYGON, number);
    vertex.look = polygon_look(number);
    vertex.local = in_pattern(vec3f(vertex.on_face, 0.0), vec3f(vertex.sides, 0.0), frame.typical_radius, number);
    vertex.unit = frame.typical_radius;
    return vertex;
}

/// The corners of the first facet of a polygon have the indices 0 to 5. Only cones and balls have others.
fn polygon_corner(index: u32, number: u32) -> FlatVertex {
    let at = frame.polygons_at + 10u * number;
    let surface = topology[at + 9u];
    if surface >= CONE {
        return corner_of_round(index, number);
    }
    var left = topology_vector(at + 3u);
    var right = topology_vector(at + 6u);
    let is_triangle = surface == TRIANGLE;
    // The second half of a quad is not drawn for a triangle: its corners are in one place.
    let shown = select(index, min(index, 2u), is_triangle);
    let base = topology_vector(at);
    var corner = base + way_into_box(base + 0.5 * (left + right));
    if surface == PLANE {
        let normal = normalize(cross(left, right));
        corner = frame.stage + dot(base - frame.stage, normal) * normal - frame.stage_size * (left + right);
        left *= 2.0 * frame.stage_size;
        right *= 2.0 * frame.stage_size;
    }
    var vertex = face(corner, left, right, normalize(cross(left, right)), shown);
    vertex.rim = select(1.0, 0.0, is_triangle);
    let pixel = pixel_width() * max(dot(vertex.point - frame.eye, frame.forward), 0.0);
    let more = OVERLAP * pixel * (2.0 * quad_corner(shown) - 1.0);
    vertex.on_face += more;
    vertex.point += more.x / vertex.sides.x * left + more.y / vertex.sides.y * right;
    vertex.place = frame.view_projection * vec4f(vertex.point, 1.0);
    vertex.colour = object_colour(KIND_POLYGON, number);
    vertex.look = polygon_look(number);
    vertex.local = in_pattern(vec3f(vertex.on_face - 0.5 * vertex.sides, 0.0), vec3f(vertex.sides, 0.0), frame.typical_radius, number);
    vertex.unit = frame.typical_radius;
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
    let stripe = fwidth(vertex.local.w);
    let view = normalize(frame.eye - vertex.point);
    if vertex.look == LOOK_GLASS {
        return glass(vertex.colour, vertex.normal, view, rim_at(vertex, 1.6 * width));
    }
    let lines = select(0.0, 0.14 * grid_at(vertex.on_face, width), vertex.look == LOOK_USUAL);
    let colour = patterned(vertex, width, stripe) * (1.0 - lines - 0.25 * rim_at(vertex, width));
    return vec4f(lit(colour, vertex.point, vertex.normal, view, gloss_of(vertex.look)), 1.0);
}

@fragment
fn edges_surface(vertex: FlatVertex) -> @location(0) vec4f {
    let opacity = 0.45 * vertex.rim * rim_at(vertex, fwidth(vertex.on_face));
    return vec4f(vec3f(0.16, 0.18, 0.21), 1.0) * opacity;
}

@fragment
fn polygon_surface(vertex: FlatVertex) -> @location(0) vec4f {
    let width = fwidth(vertex.on_face);
    let stripe = fwidth(vertex.local.w);
    let view = normalize(frame.eye - vertex.point);
    let is_front = dot(vertex.normal, view) > 0.0;
    if vertex.look == LOOK_GLASS {
        return glass(vertex.colour, vertex.normal, view, vertex.rim * rim_at(vertex, 1.6 * width));
    }
    // Both sides of a triangle can be touched.
    let brightness = select(BACK, 1.0, is_front | (vertex.rim == 0.0));
    let colour = patterned(vertex, width, stripe) * brightness * (1.0 - 0.35 * vertex.rim * rim_at(vertex, width));
    let normal = select(-vertex.normal, vertex.normal, is_front);
    return vec4f(lit(colour, vertex.point, normal, view, gloss_of(vertex.look)), 1.0);
}
