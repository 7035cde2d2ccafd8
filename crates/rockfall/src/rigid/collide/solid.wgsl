// requires rigid/collide/manifold.wgsl

// Vertices, faces and edges of cores (docs/physics section 11.13).
//
// A hull has its lists in `hulls`, from row `more` of its shape on, four words a row: (numbers of vertices, faces and edges, width);
// vertices (x, y, z, 0); faces (unit normal, first corner | number of corners << 16); edges of 4 bytes (two vertices, the two faces beside
// them), four a row; corners of all faces, one byte each.

struct Solid {
    shape: Shape,
    position: vec3f,
    axes: mat3x3f,
}

fn hull_counts(shape: Shape) -> vec3u {
    return hulls[shape.more].xyz;
}

// Half the edges with the signs of vertex k of a box.
fn vertex_of_box(extent: vec3f, k: u32) -> vec3f {
    return select(-extent, extent, (vec3u(k) & vec3u(1u, 2u, 4u)) != vec3u(0u));
}

// 4 for a parallelogram, 3 for a triangle.
fn corners_of_core_face(shape: Shape) -> u32 {
    return select(4u, 3u, (shape.more & TRIANGLE) != 0u);
}

fn vertex_of_core_face(shape: Shape, k: u32) -> vec3f {
    let u = shape.size.xy;
    if (shape.more & TRIANGLE) != 0u {
        return vec3f(select(select(shape.size.zw, -u - shape.size.zw, k == 2u), u, k == 0u), 0.0);
    }
    let v = shape.size.zw * unit_sign(u.x * shape.size.w - u.y * shape.size.z);
    return vec3f(select(-u, u, k == 1u || k == 2u) + select(-v, v, k >= 2u), 0.0);
}

fn vertices_of_core(shape: Shape) -> u32 {
    if HULLS & (shape.core == CORE_HULL) {
        return hull_counts(shape).x;
    }
    return select(select(2u, 8u, shape.core == CORE_BOX), corners_of_core_face(shape), shape.core == CORE_FACE);
}

fn vertex_of_core(shape: Shape, k: u32) -> vec3f {
    if HULLS & (shape.core == CORE_HULL) {
        return bitcast<vec3f>(hulls[shape.more + 1u + k].xyz);
    }
    if shape.core == CORE_FACE {
        return vertex_of_core_face(shape, k);
    }
    // A segment has its length along y.
    let is_box = shape.core == CORE_BOX;
    let extent = select(vec3f(0.0, shape.size.x, 0.0), shape.size.xyz, is_box);
    return vertex_of_box(extent, select(2u * k, k, is_box));
}

fn faces_of_core(shape: Shape) -> u32 {
    if HULLS & (shape.core == CORE_HULL) {
        return hull_counts(shape).y;
    }
    return select(6u, 2u + corners_of_core_face(shape), shape.core == CORE_FACE);
}

fn normal_of_core(shape: Shape, face: u32) -> vec3f {
    if HULLS & (shape.core == CORE_HULL) {
        return bitcast<vec3f>(hulls[shape.more + 1u + hull_counts(shape).x + face].xyz);
    }
    if shape.core == CORE_FACE && face >= 2u {
        let end = select(face - 1u, 0u, face - 1u == corners_of_core_face(shape));
        let along = vertex_of_core_face(shape, end) - vertex_of_core_face(shape, face - 2u);
        return normalize(vec3f(along.y, -along.x, 0.0));
    }
    let axis = select(face >> 1u, 2u, shape.core == CORE_FACE);
    return select(vec3f(0.0), vec3f(select(1.0, -1.0, (face & 1u) == 1u)), vec3u(0u, 1u, 2u) == vec3u(axis));
}

fn corners_of_core(shape: Shape, face: u32) -> u32 {
    if HULLS & (shape.core == CORE_HULL) {
        return hulls[shape.more + 1u + hull_counts(shape).x + face].w >> 16u;
    }
    return select(4u, select(corners_of_core_face(shape), 2u, face >= 2u), shape.core == CORE_FACE);
}

// The number of corner k of a face, counterclockwise from outside.
fn corner_of_core(shape: Shape, face: u32, k: u32) -> u32 {
    if HULLS & (shape.core == CORE_HULL) {
        let counts = hull_counts(shape);
        let faces = shape.more + 1u + counts.x;
        let at = (hulls[faces + face].w & 65535u) + k;
        let word = hulls[faces + counts.y + (counts.z + 3u) / 4u + (at >> 4u)][(at >> 2u) & 3u];
        return (word >> (8u * (at & 3u))) & 255u;
    }
    if shape.core == CORE_FACE {
        let count = corners_of_core_face(shape);
        let side = select(face - 2u + k, 0u, face - 2u + k == count);
        return select(select(side, count - 1u - k, face == 1u), k, face == 0u);
    }
    let axis = face >> 1u;
    let is_negative = face & 1u;
    let first = select(0u, 1u, k == 1u || k == 2u);
    let second = k >> 1u;
    let bits = select(vec2u(first, second), vec2u(second, first), is_negative == 1u);
    return ((1u - is_negative) << axis) | (bits.x << ((axis + 1u) % 3u)) | (bits.y << ((axis + 2u) % 3u));
}

fn edges_of_core(shape: Shape) -> u32 {
    if HULLS & (shape.core == CORE_HULL) {
        return hull_counts(shape).z;
    }
    return select(12u, 2u * corners_of_core_face(shape), shape.core == CORE_FACE);
}

// Two vertices, and the two faces beside them.
fn edge_of_core(shape: Shape, edge: u32) -> vec4u {
    if HULLS & (shape.core == CORE_HULL) {
        let counts = hull_counts(shape);
        let word = hulls[shape.more + 1u + counts.x + counts.y + (edge >> 2u)][edge & 3u];
        return (vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
    }
    if shape.core == CORE_FACE {
        let count = corners_of_core_face(shape);
        let below = u32(edge >= count);
        let at = edge - below * count;
        return vec4u(at, select(at + 1u, 0u, at + 1u == count), below, 2u + at);
    }
    let k = edge & 3u;
    let axis = edge >> 2u;
    let low = select(0u, 1u, axis == 0u);
    let high = select(2u, 1u, axis == 2u);
    let start = ((k & 1u) << low) | ((k >> 1u) << high);
    return vec4u(start, start | (1u << axis), 2u * low + 1u - (k & 1u), 2u * high + 1u - (k >> 1u));
}

fn vertex_of(solid: Solid, k: u32) -> vec3f {
    return solid.position + solid.axes * vertex_of_core(solid.shape, k);
}

fn normal_of(solid: Solid, face: u32) -> vec3f {
    return solid.axes * normal_of_core(solid.shape, face);
}

fn corner_of(solid: Solid, face: u32, k: u32) -> vec3f {
    return vertex_of(solid, corner_of_core(solid.shape, face, k));
}

// The next corner in the ring.
fn corner_after(solid: Solid, face: u32, k: u32) -> vec3f {
    return corner_of(solid, face, select(k + 1u, 0u, k + 1u == corners_of_core(solid.shape, face)));
}

// Greatest coordinate of a vertex about the position: the scale of rounding errors.
fn extent_of_solid(solid: Solid) -> f32 {
    var scale = 0.0;
    for (var k = 0u; k < 64u && k < vertices_of_core(solid.shape); k++) {
        scale = max(scale, greatest_of(abs(solid.axes * vertex_of_core(solid.shape, k))));
    }
    return scale;
}

// A unit vector, or 0 for 0.
fn unit_or_zero(v: vec3f) -> vec3f {
    let square = dot(v, v);
    return select(vec3f(0.0), v * inverseSqrt(max(square, 1e-37)), square > 1e-37);
}

// How far along two lines with unit directions their closest points are, and whether there are some (1) or the lines are parallel (0).
fn closest_of_lines(start: vec3f, along: vec3f, other: vec3f, across: vec3f) -> vec3f {
    let product = cross(along, across);
    let square = dot(product, product);
    let offset = other - start;
    let places = vec2f(dot(cross(offset, across), product), dot(cross(offset, along), product));
    return vec3f(places / max(square, 1e-7), select(0.0, 1.0, square >= 1e-7));
}

// Whether a place is on an edge of this length, up to a part of it.
fn is_on_edge(at: f32, size: f32) -> bool {
    return at > -1e-4 * size && at < 1.0001 * size;
}
