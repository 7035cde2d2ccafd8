// requires

// Shapes, contact points and the choice of four of them (docs/physics.md section 11.13).

// Cores, in the order of the table. A pair is solved with the earlier core first.
const CORE_HALF_SPACE: u32 = 0u;
const CORE_FACE: u32 = 1u;
const CORE_BOX: u32 = 2u;
const CORE_HULL: u32 = 3u;
const CORE_SEGMENT: u32 = 4u;
const CORE_POINT: u32 = 5u;

// What is in a scene, so that kernels without it are small: hulls; capsules; pairs of faces, boxes and hulls other than two boxes without
// radii.
const HULLS: bool = true;
const CAPSULES: bool = true;
const SOLIDS: bool = true;

const MOST_POINTS: u32 = 4u;
// Corners of two quadrilaterals; a kernel for hulls has 64.
const MOST_CANDIDATES: u32 = 8u;
const EPSILON: f32 = 1.1920929e-7;
// Less than any separation.
const NO_SEPARATION: f32 = -3e38;

// A core and a radius: two rows of four words in memory.
struct Shape {
    // Box: half the edges. Segment: half the length in x. Face: u.x, u.y, v.x, v.y. Others: not used.
    size: vec4f,
    radius: f32,
    core: u32,
    // Hull: where its lists begin. Face: 1 if it is touched from one side only.
    more: u32,
    spare: u32,
}

struct Manifold {
    // Unit vector from a to b.
    normal: vec3f,
    // 0 for no contact.
    count: u32,
    // Places on the surfaces.
    on_a: array<vec3f, 4>,
    on_b: array<vec3f, 4>,
    ids: array<u32, 4>,
}

// Points of which up to four become contacts.
struct Candidates {
    count: u32,
    // Place on the core of the first shape, and the separation of the cores: the other place is that far along the normal.
    places: array<vec4f, MOST_CANDIDATES>,
    ids: array<u32, MOST_CANDIDATES>,
}

fn id_of_corner(b_is_reference: bool, reference: u32, incident: u32, before: u32, after: u32) -> u32 {
    let faces = (select(0u, 1u, b_is_reference) << 12u) | (reference << 6u) | incident;
    return (1u << 30u) | (faces << 12u) | (before << 6u) | after;
}

fn id_of_edges(of_a: u32, of_b: u32) -> u32 {
    return (2u << 30u) | (of_a << 12u) | of_b;
}

fn id_of_vertex(number: u32) -> u32 {
    return (3u << 30u) | number;
}

fn id_of_closest(of_a: u32, of_b: u32) -> u32 {
    return (of_a << 12u) | of_b;
}

// 1 for 0 too, unlike `sign`.
fn unit_sign(value: f32) -> f32 {
    return select(1.0, -1.0, value < 0.0);
}

fn greatest_of(v: vec3f) -> f32 {
    return max(v.x, max(v.y, v.z));
}

fn least_of(v: vec3f) -> f32 {
    return min(v.x, min(v.y, v.z));
}

// The coordinates in a ring, from number i on.
fn cycled(v: vec3f, i: u32) -> vec3f {
    return select(select(v.zxy, v.yzx, i == 1u), v, i == 0u);
}

// Takes `cycled` back.
fn uncycled(v: vec3f, i: u32) -> vec3f {
    return select(select(v.yzx, v.zxy, i == 1u), v, i == 0u);
}

// The columns in a ring, from number j on.
fn cycled_columns(m: mat3x3f, j: u32) -> mat3x3f {
    if j == 0u {
        return m;
    }
    if j == 1u {
        return mat3x3f(m[1], m[2], m[0]);
    }
    return mat3x3f(m[2], m[0], m[1]);
}

fn no_contact() -> Manifold {
    return Manifold();
}

// One point: places on both cores.
fn one_point(normal: vec3f, on_a: vec3f, on_b: vec3f, radii: vec2f, id: u32) -> Manifold {
    var manifold = Manifold();
    manifold.normal = normal;
    manifold.count = 1u;
    manifold.on_a[0] = on_a + radii.x * normal;
    manifold.on_b[0] = on_b - radii.y * normal;
    manifold.ids[0] = id;
    return manifold;
}

fn least_separation(manifold: ptr<function, Manifold>) -> f32 {
    var least = 3e38;
    for (var k = 0u; k < MOST_POINTS && k < (*manifold).count; k++) {
        least = min(least, dot((*manifold).on_b[k] - (*manifold).on_a[k], (*manifold).normal));
    }
    return least;
}

// Exchanges the shapes of a manifold, and turns it to coordinates in which those of its first shape have this position and these axes.
fn exchange_shapes(manifold: ptr<function, Manifold>, position: vec3f, axes: mat3x3f) {
    (*manifold).normal = -(axes * (*manifold).normal);
    for (var k = 0u; k < MOST_POINTS && k < (*manifold).count; k++) {
        let on_a = position + axes * (*manifold).on_b[k];
        (*manifold).on_b[k] = position + axes * (*manifold).on_a[k];
        (*manifold).on_a[k] = on_a;
    }
}

// The first of the values that are nearly the greatest, up to a part of it and a margin.
fn first_of_greatest(values: ptr<function, array<f32, MOST_CANDIDATES>>, count: u32, part: f32, margin: f32) -> u32 {
    var most = NO_SEPARATION;
    for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
        most = max(most, (*values)[k]);
    }
    let enough = most - part * abs(most) - margin;
    for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
        if (*values)[k] >= enough {
            return k;
        }
    }
    return 0u;
}

// At most four of the candidates. Of more, it takes an extreme one along a fixed direction or the deepest, the farthest from that, the
// one of the largest triangle, and the farthest on the other side.
fn reduced(candidates: ptr<function, Candidates>, normal: vec3f, along: vec3f, radii: vec2f) -> Manifold {
    let count = (*candidates).count;
    var chosen = vec4u(0u, 1u, 2u, 3u);
    var taken = min(count, 4u);
    if count > 4u {
        var values: array<f32, MOST_CANDIDATES>;
        let origin = (*candidates).places[0].xyz;
        var spread = 0.0;
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            let place = (*candidates).places[k];
            spread = max(spread, distance(place.xyz, origin));
            values[k] = -place.w - 1e-3 * dot(place.xyz, along);
        }
        chosen.x = first_of_greatest(&values, count, 0.0, 0.5e-3 * spread);
        let p = (*candidates).places[chosen.x].xyz;
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            let offset = (*candidates).places[k].xyz - p;
            values[k] = dot(offset, offset);
        }
        chosen.y = first_of_greatest(&values, count, 0.01, 0.0);
        let q = (*candidates).places[chosen.y].xyz;
        let thin = 1e-5 * dot(q - p, q - p);
        for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
            values[k] = abs(dot(cross(q - p, (*candidates).places[k].xyz - p), normal));
        }
        chosen.z = first_of_greatest(&values, count, 0.01, 0.0);
        taken = 2u;
        if values[chosen.z] > thin {
            let r = (*candidates).places[chosen.z].xyz;
            let up = unit_sign(dot(cross(q - p, r - p), normal)) * normal;
            for (var k = 0u; k < MOST_CANDIDATES && k < count; k++) {
                let place = (*candidates).places[k].xyz;
                let beyond = vec3f(
                    dot(cross(place - p, q - p), up), dot(cross(place - q, r - q), up), dot(cross(place - r, p - r), up));
                values[k] = greatest_of(beyond);
            }
            chosen.w = first_of_greatest(&values, count, 0.01, 0.0);
            taken = select(3u, 4u, values[chosen.w] > thin);
        }
    }
    var manifold = Manifold();
    manifold.normal = normal;
    manifold.count = taken;
    for (var k = 0u; k < MOST_POINTS && k < taken; k++) {
        let place = (*candidates).places[chosen[k]];
        manifold.on_a[k] = place.xyz + radii.x * normal;
        manifold.on_b[k] = place.xyz + (place.w - radii.y) * normal;
        manifold.ids[k] = (*candidates).ids[chosen[k]];
    }
    return manifold;
}
