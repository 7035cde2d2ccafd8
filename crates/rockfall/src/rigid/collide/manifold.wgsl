// requires

// Shapes and contact points (docs/physics section 11.13).

// Cores, in the order of the table. A pair is solved with the earlier core first.
const CORE_SMOOTH: u32 = 0u;
// What a smooth wall is, in `more`. All but half-spaces are touched by balls only.
const HALF_SPACE: u32 = 0u;
const CONE_FROM_OUTSIDE: u32 = 1u;
const CONE_FROM_INSIDE: u32 = 2u;
const BOWL: u32 = 3u;
const CORE_FACE: u32 = 1u;
// What a face is, in `more`.
const ONE_SIDED: u32 = 1u;
const TRIANGLE: u32 = 2u;
// Balls do not touch it.
const FACET: u32 = 4u;
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
const EPSILON: f32 = 1.1920929e-7;
// Less than any separation.
const NO_SEPARATION: f32 = -3e38;

// A core and a radius: two rows of four words in memory.
struct Shape {
    // Box: half the edges. Segment: half the length in x. Face: u.x, u.y, v.x, v.y. Cone: half the length, and the radii at its lower
    // and upper end. Bowl: the radius in x. Others: not used.
    size: vec4f,
    radius: f32,
    core: u32,
    // Hull: where its lists begin. Face, smooth wall: the bits or the number above.
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
