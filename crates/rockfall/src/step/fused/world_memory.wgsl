// requires model/step.wgsl

// What a workgroup of `run_worlds` keeps of its worlds, and what a thread keeps of its sphere. Workgroup memory has only what threads
// exchange, because a device runs more worlds at a time if each takes less.

// Room for a world: spheres, springs, and words of topology. The host replaces these numbers by those of the largest world in
// the batch (`WorldSizes`). These are the largest numbers.
const WORLD_SPHERES: u32 = 32u;
const WORLD_SPRINGS: u32 = 128u;
const WORLD_TOPOLOGY: u32 = 2304u;
// Worlds of a workgroup, and its threads. The host replaces them (`WorldBatch::group`).
const GROUP_WORLDS: u32 = 1u;
const GROUP_THREADS: u32 = 32u;
// Threads of a world. Worlds that share a workgroup have one per sphere.
const WORLD_THREADS: u32 = select(WORLD_SPHERES, GROUP_THREADS, GROUP_WORLDS == 1u);

// Below, the worlds of the workgroup one after the other.
var<workgroup> world_steps: array<Step, GROUP_WORLDS>;
var<workgroup> world_statuses: array<StatusAtomic, GROUP_WORLDS>;
// The stage state whose forces are evaluated: positions, velocities, angular momenta.
var<workgroup> state: array<vec4f, 3u * WORLD_SPHERES * GROUP_WORLDS>;
// Forces on ends A of springs.
var<workgroup> spring_forces: array<vec4f, WORLD_SPRINGS * GROUP_WORLDS>;
// Rest lengths of springs with muscles at the present evaluation.
var<workgroup> lengths: array<f32, WORLD_SPRINGS * GROUP_WORLDS>;
// Number of the last force evaluation that must find near objects again.
var<workgroup> moved: array<atomic<u32>, GROUP_WORLDS>;
// Number of the last force evaluation at the end of a step in which a sphere moved.
var<workgroup> motion: array<atomic<u32>, GROUP_WORLDS>;
// Not 0 if a world of the workgroup was not halted at the start of the dispatch.
var<workgroup> awake: atomic<u32>;

// Names that functions of the shared files need. Nothing that this kernel computes depends on them.
var<private> lists: array<array<u32, SLICE>, 1>;
var<private> aabbs: array<Aabb, WORLD_SPHERES>;
var<private> orientations: array<vec4f, 1>;

// The world of the thread in its workgroup, its first row in `state`, and its first spring.
var<private> own_world: u32;
var<private> own_rows: u32;
var<private> first_spring: u32;
// First word of the world in `topology`.
var<private> world_topology: u32;
// Number of the force evaluation in the step.
var<private> evaluated: u32;
// The rows of the sphere of this thread: at the start of the step, and in the next stage state.
var<private> start: array<vec4f, 4>;
var<private> next: array<vec4f, 4>;
// What stage states 2 and 3 contribute to the state at the end of the step, to the mean spin,
// and to the mean velocity. They need no other rows.
var<private> changes: array<vec3f, 3>;
var<private> momenta: vec3f;
var<private> velocities: vec3f;

fn position_at(sphere: u32) -> u32 {
    return own_rows + sphere;
}

fn velocity_at(sphere: u32) -> u32 {
    return own_rows + WORLD_SPHERES + sphere;
}

// Not used: the low parts of positions are with the thread of the sphere.
fn low_at(sphere: u32) -> u32 {
    return sphere;
}

// Asked for by the thread of the sphere, in the state at the start of the step.
fn low_row(sphere: u32) -> vec3f {
    return start[3].xyz;
}

// Not used: worlds whose velocities have residues have simulations of their own.
fn residue_row(region: u32, sphere: u32) -> vec4f {
    return vec4f(0.0);
}

fn momentum_at(sphere: u32) -> u32 {
    return own_rows + 2u * WORLD_SPHERES + sphere;
}

fn evaluation() -> u32 {
    return evaluated;
}

// The rows of a sphere are asked for by its own thread.
fn start_row(region: u32, i: u32) -> vec4f {
    return start[region];
}

fn put_start(region: u32, i: u32, row: vec4f) {
    start[region] = row;
}

fn put_next(region: u32, i: u32, row: vec4f) {
    next[region] = row;
}

fn early_changes(region: u32, i: u32, y: vec3f) -> vec3f {
    return changes[region];
}

fn early_velocities(i: u32, start_velocity: vec3f) -> vec3f {
    return velocities;
}

fn early_momenta(i: u32, start_momentum: vec3f) -> vec3f {
    return momenta;
}

// Asked for in evaluation 3.
fn y4_row(region: u32, i: u32) -> vec4f {
    return state[own_rows + region * WORLD_SPHERES + i];
}

// Shows rows of the sphere of this thread to the others.
fn show(i: u32, position: vec4f, velocity: vec4f, momentum: vec4f) {
    state[position_at(i)] = position;
    state[velocity_at(i)] = velocity;
    state[momentum_at(i)] = momentum;
}
