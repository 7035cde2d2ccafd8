// requires

// Rows of the flat arrays of a frame of the law `rigid` (docs/physics chapter 11). `rigid/gpu/rows.rs` has the same rows for the host.
//
// | array | rows of an entry |
// |---|---|
// | `bodies` | x, clock; q; v, 1/m; omega, path; I^-1 xx yy zz, left-over blocks; I^-1 xy xz yz, margin; L, rho; v_0, stopped; omega_0, hits or reflections in the substep; until then its home |
// | `constants` | principal axes; J, width; g + (F + F_s)/m, 1 with springs or joints; torque, home. After all bodies: the velocities of the surfaces of the colliders, a row each |
// | `blocks` | a, b, first pair, pairs; first point, info, time, 0 |
// | `pairs` | n, mu; belt (2), first point, info; n in coordinates of a, e; colliders (2), a, b |
// | `points` | l_A, id; l_B, for the first one of a pair the normal impulse of its impacts in the frame |
// | `contacts` | r_A, s; N, T_1, T_2, kappa. An entry for each point |
// | `loads` | of each block: impulse; moment on a; moment on b. After all blocks, of each left-over block 8 rows: changes of v_a, omega_a, v_b, omega_b; in impacts others |
// | `lists` | of each body and one more: its first entry; then the entries: block * 2, + 1 if the body is b |
//
// A body has mass if 1/m > 0. The world is a body without mass that rests. Bits that are no f32 lie in arrays of u32.

struct Frame {
    gravity: vec3f,
    // Length of a substep, in s.
    h: f32,
    bodies: u32,
    blocks: u32,
    // First left-over block.
    left_over: u32,
    substeps: u32,
    // m_s, r, i_s of blocks with two masses, and of fixed ones.
    soft: array<vec4f, 2>,
    // First block of each colour, of the left-over ones, and their end.
    colours: array<vec4u, 5>,
    // Periods, and 1 over them; 0 along axes that are not periodic. The lower corner of the box.
    period: vec3f,
    per_period: vec3f,
    box_start: vec3f,
}

struct Call {
    colour: u32,
    // 1 in the biased pass, 0 in the relax pass.
    biased: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> call: Call;
@group(0) @binding(2) var<storage, read_write> bodies: array<vec4f>;
@group(0) @binding(3) var<storage, read> constants: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> blocks: array<vec4u>;
@group(0) @binding(5) var<storage, read_write> pairs: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> points: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> contacts: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> loads: array<vec4f>;
@group(0) @binding(9) var<storage, read> lists: array<u32>;

const BODY_ROWS: u32 = 9u;
const CONSTANT_ROWS: u32 = 4u;
const BLOCK_ROWS: u32 = 2u;
const PAIR_ROWS: u32 = 4u;
const POINT_ROWS: u32 = 2u;
const LOAD_ROWS: u32 = 3u;
const COPY_ROWS: u32 = 8u;
const COLOURS: u32 = 16u;
const THREADS: u32 = 64u;

// Flags of a block.
const FIXED: u32 = 0x01000000u;
const WAITS: u32 = 0x04000000u;
const ELASTIC: u32 = 0x08000000u;
const SEAMS: u32 = 0x10000000u;
// Flags of a pair.
const OPENS: u32 = 0x00010000u;
const ROUND: u32 = 0x00020000u;
const BELT: u32 = 0x00040000u;
const BALL: u32 = 0x00080000u;
// The pair matters without a hit by a third body.
const NEAR: u32 = 0x00100000u;

struct Motion {
    velocity: vec3f,
    spin: vec3f,
}

// 1/m and I^-1: xx yy zz, and xy xz yz.
struct Mass {
    inverse: f32,
    diagonal: vec3f,
    beside: vec3f,
}

struct Block {
    a: u32,
    b: u32,
    first_pair: u32,
    pairs: u32,
    first_point: u32,
    info: u32,
    time: f32,
}

// A pair in the pose of the last refresh.
struct Face {
    normal: vec3f,
    friction: f32,
    belt: vec2f,
    first: u32,
    info: u32,
}

// The linear index of a thread. Dispatches have two dimensions, because one may be limited to 65,535 workgroups.
fn thread_of(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return (group.x + group.y * groups.x) * THREADS + local;
}

fn colour_start(colour: u32) -> u32 {
    return frame.colours[colour / 4u][colour % 4u];
}

fn has_mass(body: u32) -> bool {
    return bodies[BODY_ROWS * body + 2u].w > 0.0;
}

fn place_of(body: u32) -> vec3f {
    return bodies[BODY_ROWS * body].xyz;
}

// What moves the end of a way to its image nearest to the start.
fn to_nearest(way: vec3f) -> vec3f {
    return -frame.period * floor(way * frame.per_period + vec3f(0.5));
}

// What moves body b to its image nearest to body a. Bodies without mass are there in all images.
fn image_of(a: u32, b: u32) -> vec3f {
    if all(frame.period == vec3f(0.0)) || !has_mass(a) || !has_mass(b) {
        return vec3f(0.0);
    }
    return to_nearest(place_of(b) - place_of(a));
}

// From the centre of body a to that of body b.
fn between(a: u32, b: u32) -> vec3f {
    return (place_of(b) - place_of(a)) + image_of(a, b);
}

// The first body of its world, in worlds that share a frame; 0 of the static body, which all have, and of all bodies of a single world.
// Known in the search and in the assembly.
fn home_of(body: u32) -> u32 {
    return u32(bodies[BODY_ROWS * body + 8u].w);
}

fn turn_of(body: u32) -> vec4f {
    return bodies[BODY_ROWS * body + 1u];
}

fn motion_of(body: u32) -> Motion {
    return Motion(bodies[BODY_ROWS * body + 2u].xyz, bodies[BODY_ROWS * body + 3u].xyz);
}

fn put_motion(body: u32, motion: Motion) {
    let at = BODY_ROWS * body + 2u;
    bodies[at] = vec4f(motion.velocity, bodies[at].w);
    bodies[at + 1u] = vec4f(motion.spin, bodies[at + 1u].w);
}

fn mass_of(body: u32) -> Mass {
    let at = BODY_ROWS * body;
    return Mass(bodies[at + 2u].w, bodies[at + 4u].xyz, bodies[at + 5u].xyz);
}

// The number of left-over blocks of a body.
fn share_of(body: u32) -> f32 {
    return bodies[BODY_ROWS * body + 4u].w;
}

// Speed of the surface of a turning body at most. An infinite radius counts only if the body turns.
fn turning_speed(body: u32, spin: vec3f) -> f32 {
    let rate = length(spin);
    return select(bodies[BODY_ROWS * body + 6u].w * rate, 0.0, rate == 0.0);
}

// I^-1 times a vector.
fn respond(mass: Mass, moment: vec3f) -> vec3f {
    let d = mass.diagonal;
    let e = mass.beside;
    return vec3f(
        d.x * moment.x + e.x * moment.y + e.y * moment.z,
        e.x * moment.x + d.y * moment.y + e.z * moment.z,
        e.y * moment.x + e.z * moment.y + d.z * moment.z,
    );
}

fn block_at(k: u32) -> Block {
    let one = blocks[BLOCK_ROWS * k];
    let two = blocks[BLOCK_ROWS * k + 1u];
    return Block(one.x, one.y, one.z, one.w, two.x, two.y, bitcast<f32>(two.z));
}

fn face_at(pair: u32) -> Face {
    let one = bitcast<vec4f>(pairs[PAIR_ROWS * pair]);
    let two = pairs[PAIR_ROWS * pair + 1u];
    return Face(one.xyz, one.w, bitcast<vec2f>(two.xy), two.z, two.w);
}

fn count_of(face: Face) -> u32 {
    return face.info & 0xffu;
}

// The tangents of a normal: the first one of them.
fn tangent_one(n: vec3f) -> vec3f {
    let sigma = select(-1.0, 1.0, n.z >= 0.0);
    let c = -1.0 / (sigma + n.z);
    return vec3f(1.0 + sigma * n.x * n.x * c, sigma * (n.x * n.y * c), -sigma * n.x);
}

fn tangent_two(n: vec3f) -> vec3f {
    let sigma = select(-1.0, 1.0, n.z >= 0.0);
    let c = -1.0 / (sigma + n.z);
    return vec3f(n.x * n.y * c, sigma + n.y * n.y * c, -n.y);
}
