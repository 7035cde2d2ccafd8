// requires model/step_block.wgsl

// Declarations for every kernel: the uniform blocks, the status block, and the constants of layout.rs and status.rs. A test
// compares them with the Rust declarations. `Step` is declared by step_block.wgsl, which step.rs generates.

struct Pass {
    index: u32,
    rest_steps: u32,
    rest_speed: f32,
    zero: u32,
}

struct Aabb {
    min: vec3f,
    id: u32,
    max: vec3f,
    tag: u32,
}

struct Counters {
    contacts: u32,
    max_overlap: u32,
    collisions: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    pad_3: u32,
    pad_4: u32,
}

struct Status {
    counters: array<Counters, COUNTER_BLOCKS>,
    rejected: u32,
    pair_rows_needed: u32,
    escape_ratio: u32,
    steps: u32,
    collided: u32,
    lengths_due: u32,
    forces_due: u32,
    collides: u32,
    last_contacts: u32,
    last_max_overlap: u32,
    last_collisions: u32,
    total_collisions_low: u32,
    total_collisions_high: u32,
    bad_body: u32,
    bad_step: u32,
    bad_count: u32,
    total_bad: u32,
    first_bad: u32,
    rebuild: u32,
    builds: u32,
    order_entries: u32,
    order_digits: u32,
    listed: u32,
    clustered: u32,
    clustered_steps: u32,
    many_steps: u32,
    history_table: u32,
    history_blocks: u32,
    history_needed: u32,
    repeats: u32,
    repeated: u32,
    repeat_escape: u32,
}

// `Counters` and `Status` for stages in which many threads of a dispatch write them.
struct CountersAtomic {
    contacts: atomic<u32>,
    max_overlap: atomic<u32>,
    collisions: atomic<u32>,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    pad_3: u32,
    pad_4: u32,
}

struct StatusAtomic {
    counters: array<CountersAtomic, COUNTER_BLOCKS>,
    rejected: atomic<u32>,
    pair_rows_needed: atomic<u32>,
    escape_ratio: atomic<u32>,
    steps: u32,
    collided: atomic<u32>,
    lengths_due: u32,
    forces_due: u32,
    collides: atomic<u32>,
    last_contacts: u32,
    last_max_overlap: u32,
    last_collisions: u32,
    total_collisions_low: u32,
    total_collisions_high: u32,
    bad_body: atomic<u32>,
    bad_step: u32,
    bad_count: atomic<u32>,
    total_bad: u32,
    first_bad: u32,
    rebuild: atomic<u32>,
    builds: u32,
    order_entries: atomic<u32>,
    order_digits: atomic<u32>,
    listed: atomic<u32>,
    clustered: atomic<u32>,
    clustered_steps: u32,
    many_steps: u32,
    history_table: u32,
    history_blocks: atomic<u32>,
    history_needed: u32,
    repeats: u32,
    repeated: u32,
    repeat_escape: u32,
}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<uniform> pass_: Pass;

// Whether the scene has rods (RODS), large spheres, each of which gets a workgroup (LARGE), springs with muscles
// (MUSCLES), pairs of materials (MATERIALS), pairs with rolling or twisting resistance (RESISTANCE), and pairs with
// cohesion (COHESION). Whether the integrator is velocity Verlet (VERLET). Whether geometry uses the low parts of positions (DOUBLE).
// Kernels for scenes without them are smaller and faster.
const RODS: bool = true;
const LARGE: bool = true;
const MUSCLES: bool = true;
const MATERIALS: bool = true;
const RESISTANCE: bool = true;
const COHESION: bool = true;
// Whether a sphere may leave the ball in which its list holds all pairs. `run_worlds` has no lists.
const ESCAPES: bool = true;
const VERLET: bool = true;
// Whether the integrator is symplectic Euler, with velocities half a step behind positions.
const HALF_STEP: bool = true;
// Whether springs, tethers, external forces or forces of a program act, so that there is a table `free_at`.
const FREE_TABLE: bool = true;
const DOUBLE: bool = true;
// Regions of a state. Each is a vec4f per sphere.
const STATE_REGIONS: u32 = 4u;
// The same in the phase of collisions.
const COLLISION_REGIONS: u32 = STATE_REGIONS + u32(HALF_STEP);
// Whether contacts that begin and end within a step are handled.
const CONTINUOUS: bool = true;
// The contact law. Kernels are compiled for one law.
const LAW: u32 = 1u;

const WORKGROUP: u32 = 64u;
const WIDE_WORKGROUP: u32 = 256u;
const SLICE: u32 = 32u;

const ROD_WORDS: u32 = 4u;
const SPRING_WORDS: u32 = 5u;
const MUSCLE_WORDS: u32 = 5u;
const TETHER_WORDS: u32 = 7u;
const FORCE_WORDS: u32 = 3u;
const BOX_WORDS: u32 = 12u;
const POLYGON_WORDS: u32 = 9u;
const PAIR_WORDS: u32 = 12u;
const MATERIAL_SHIFT: u32 = 16u;
const LAW_THESIS: u32 = 0u;
const LAW_LINEAR: u32 = 1u;
const LAW_HERTZ_MINDLIN: u32 = 2u;
const LAW_USER: u32 = 3u;
// Distance over which the stiffness of the law that the program defines is found, per overlap.
const USER_REACH: f32 = 0.01;
const TANGENTIAL_RATIO: f32 = 2.0 / 7.0;
const HISTORY_WORDS: u32 = 8u;
const HISTORY_BLOCK: u32 = 4u;
const NO_KEY: u32 = 0xffffffffu;
const LINK_KEY: u32 = 0x80000000u;
const GROUP_MASK: u32 = (1u << MATERIAL_SHIFT) - 1u;

const KIND_SHIFT: u32 = 30u;
const NO_ROD: u32 = 0xffffffffu;
const SOME_RODS: u32 = 0xfffffffeu;
const NO_NETWORK: u32 = 0xffffffffu;
const KIND_ROD: u32 = 0u;
const KIND_SPRING: u32 = 1u;
const KIND_TETHER: u32 = 2u;
const KIND_FORCE: u32 = 3u;

const COUNTER_BLOCKS: u32 = 64u;

// Without rods, all contacts have feature 0, and ids get all bits.
const FEATURE_BITS: u32 = 4u * u32(RODS);
const FEATURE_MASK: u32 = (1u << FEATURE_BITS) - 1u;
const ENTRY_ID_BITS: u32 = 30u - FEATURE_BITS;
const ENTRY_ID_MASK: u32 = (1u << ENTRY_ID_BITS) - 1u;
const ENTRY_OVERLAPS: u32 = 0x40000000u;
const ENTRY_COLLIDES: u32 = 0x80000000u;
const LIST_COLLIDES: u32 = 0x80000000u;
const LIST_COUNT_MASK: u32 = 0x7fffffffu;
const BOX_FEATURES: u32 = 12u;

const EDGES_AT: u32 = 32u;
const FARTHEST_AT: u32 = 64u;
const CELLS_AT: u32 = 96u;
const LEVELS: u32 = 32u;
const CELL_BLOCK: u32 = 4096u;
const SUM_WORDS: u32 = 4u;
const DIGIT_BLOCK: u32 = 1024u;
const DIGITS: u32 = 16u;
const DIGIT_BITS: u32 = 4u;
const ORDER_SAMPLE: u32 = 65536u;
const FEW_STATICS: u32 = 32u;
const LEVEL_BIAS: u32 = 8u;
const LONG_LEVEL: u32 = 11u;
const TOP_LEVEL: u32 = 31u;
const ROW_Y: u32 = 0x9e3779b1u;
const ROW_Z: u32 = 0x85ebca77u;
const ROW_LEVEL: u32 = 0xc2b2ae3du;

const FLAG_COLLISIONS: u32 = 1u;
const FLAG_PULL: u32 = 2u;
const FLAG_CONTINUE: u32 = 4u;
const FLAG_GROUPS: u32 = 8u;
const FLAG_PAIR_FRICTION: u32 = 32u;
const FLAG_RESISTANCE: u32 = 64u;
const FLAG_COHESION: u32 = 128u;
const FLAG_VERLET: u32 = 256u;
const FLAG_DOUBLE: u32 = 512u;
const FLAG_HALF_STEP: u32 = 2048u;
const FLAG_CONTINUOUS: u32 = 1024u;
const RATE_WORDS: u32 = 6u;
const ROUNDING_SLACK: f32 = 4e-7;
const ROUNDING_MARGIN: f32 = 1e-6;

const REJECTED_PAIRS: u32 = 1u;
const REJECTED_ESCAPED: u32 = 2u;
const REJECTED_NON_FINITE: u32 = 4u;
const REJECTED_COUNT: u32 = 8u;
const REJECTED_COLLISIONS: u32 = 16u;
const REJECTED_MANY: u32 = 32u;
const REJECTED_HISTORY: u32 = 64u;
const REJECTED_NETWORKS: u32 = 128u;

const REBUILD_REQUESTED: u32 = 1u;
const REBUILD_DONE: u32 = 2u;
const REBUILD_UNDER_WAY: u32 = 3u;

const SWEEPS_OFF: u32 = 0u;
const SWEEPS_LISTED: u32 = 1u;
const SWEEPS_FEW: u32 = 2u;
const SWEEPS_ON: u32 = 3u;
const FEW_COLLISIONS: u32 = 2048u;
const SWEEPS: u32 = 8u;
const SWEEP_SIZES: vec4f = vec4f(1.25098, 2.66852, 1.81611, 1.0);
const COLLISION_WORDS: u32 = 48u;

const STEPS_SHIFT: u32 = 1u;
const SYMPLECTIC_EULER: u32 = 1u;

const NO_BODY: u32 = 0xffffffffu;
const BAD_STAGE_SHIFT: u32 = 29u;

// "No object", in place of an id or an index.
const NONE: u32 = 0xffffffffu;

// A squared length up to this counts as 0 (docs/physics.md section 2.3).
const TINY: f32 = 1e-30;

// Whether lists hold only the pairs that may touch at the present positions, see `Step::lookahead`.
fn has_exact_lists() -> bool {
    return step.lookahead == 0.0;
}

fn objects() -> u32 {
    return step.spheres + step.rods + step.boxes + step.polygons;
}

// Linear index of a workgroup. Dispatches have two dimensions, because one dimension may be limited to 65,535 workgroups.
fn linear_group(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}

fn linear_thread(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return linear_group(group, groups) * WORKGROUP + local;
}

// Linear index of a thread, for workgroups of WIDE_WORKGROUP threads.
fn wide_thread(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return linear_group(group, groups) * WIDE_WORKGROUP + local;
}

// Whether a vector is finite. It tests the exponent bits, because compilers may assume that there is no infinity or NaN and
// drop other tests.
fn finite(v: vec3f) -> bool {
    return all((bitcast<vec3u>(v) & vec3u(0x7f800000u)) != vec3u(0x7f800000u));
}
