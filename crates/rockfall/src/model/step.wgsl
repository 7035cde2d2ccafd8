// Declarations for every kernel. `model/declare.rs` adds those that have a twin in Rust: the uniform blocks, the status block with its
// twin `StatusAtomic` for stages in which many threads of a dispatch write it, and the constants of layout.rs and status.rs.

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<uniform> pass_: Pass;

// Whether the scene has rods (RODS), large spheres, each of which gets a workgroup (LARGE), springs with muscles
// (MUSCLES), moving boxes or polygons (WALLS), rigid bodies (RIGID_BODIES), triangles (TRIANGLES), smooth walls (SMOOTH), periodic boundaries (PERIODIC), pairs of materials (MATERIALS), pairs with rolling or twisting resistance (RESISTANCE), and pairs with
// cohesion (COHESION). Whether the integrator is velocity Verlet (VERLET). Whether geometry uses the low parts of positions (DOUBLE).
// Kernels for scenes without them are smaller and faster.
const RODS: bool = true;
const LARGE: bool = true;
const MUSCLES: bool = true;
const WALLS: bool = true;
const RIGID_BODIES: bool = true;
// Whether passages of spheres through polygons are counted.
const PASSAGES: bool = true;
const TRIANGLES: bool = true;
const SMOOTH: bool = true;
// Whether the scene has rods and polygons.
const ROD_POLYGONS: bool = true;
// Whether orientations are updated by stages after the integration, which leaves them the mean spins.
const LATE_TURN: bool = RODS | RIGID_BODIES;
// Whether the scene is periodic along some axis. Geometry then uses the low parts of positions, too.
const PERIODIC: bool = true;
// Whether the images of the scene slide along the box.
const SHEARED: bool = true;
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
// Whether velocities have residues (docs/physics section 5.10).
const RESIDUES: bool = true;
// Regions of a state. Each is a vec4f per sphere.
const STATE_REGIONS: u32 = 4u;
// The same in the phase of collisions.
const COLLISION_REGIONS: u32 = STATE_REGIONS + u32(HALF_STEP);
// Whether contacts that begin and end within a step are handled.
const CONTINUOUS: bool = true;
// The contact law. Kernels are compiled for one law.
const LAW: u32 = 1u;

// Without rods, all contacts have feature 0, and ids get all bits.
const FEATURE_BITS: u32 = 4u * u32(RODS);
const FEATURE_MASK: u32 = (1u << FEATURE_BITS) - 1u;
const ENTRY_ID_BITS: u32 = 30u - FEATURE_BITS;
const ENTRY_ID_MASK: u32 = (1u << ENTRY_ID_BITS) - 1u;

// "No object", in place of an id or an index.
const NONE: u32 = 0xffffffffu;

// A squared length up to this counts as 0 (docs/physics section 2.3).
const TINY: f32 = 1e-30;

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

// Whether a step with these bits of `rejected` was rejected only because a body left its AABB.
fn has_only_escaped(rejected: u32) -> bool {
    return (rejected != 0u) & ((rejected & ~(REJECTED_ESCAPED | REJECTED_BEFORE)) == 0u);
}
