// requires model/objects.wgsl model/step.wgsl model/step_block.wgsl physics/contact.wgsl
// requires physics/forces/attached.wgsl physics/forces/muscle.wgsl physics/forces/net_force.wgsl physics/geometry.wgsl
// requires physics/rotation.wgsl step/commit.wgsl step/integrate/close_step.wgsl step/integrate/finished.wgsl
// requires step/integrate/next_state.wgsl step/integrate/symplectic_euler_state.wgsl

// Each workgroup advances one world, or several small ones, for many steps, with a thread per sphere. The shared files compute the
// same here as in the stages. Where they read `step` or `status`, the host inserts those of the thread's world, and where they read
// `topology`, it inserts `world_topology`.
//
// A force evaluation has two parts, with a barrier after each. First each spring is evaluated by one thread, and each sphere adds
// up the forces of its contacts. Then each sphere adds the forces of what is attached to it, computes its next state, and shows it
// to the others. So forces are added in the same order as in the stages. Workgroup memory has only what threads exchange, because
// a device runs more worlds at a time if each takes less.

struct WorldResult {
    steps: u32,
    rejected: u32,
    contacts: u32,
    max_overlap: u32,
    total_bad: u32,
    first_bad: u32,
    bad_step: u32,
    calm: u32,
}

@group(0) @binding(2) var<storage, read> parameters: array<Step>;
@group(0) @binding(3) var<storage, read_write> starts: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read_write> turns: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> results: array<WorldResult>;

// Room for a world: spheres, springs, and words of topology. The host replaces these numbers by those of the largest world in
// the batch (`WorldSizes`). These are the largest numbers.
const WORLD_SPHERES: u32 = 32u;
const WORLD_SPRINGS: u32 = 128u;
const WORLD_TOPOLOGY: u32 = 2304u;
// Two spheres of a world may be in the same group. The host replaces it. Without, there is no code for pairs of spheres.
const SPHERE_PAIRS: bool = true;
// Worlds of a workgroup, and its threads. The host replaces them (`WorldSizes::group`). Several worlds have a thread per sphere.
const GROUP_WORLDS: u32 = 1u;
const GROUP_THREADS: u32 = 32u;
// Threads of a world.
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
var<private> start: array<vec4f, 3>;
var<private> next: array<vec4f, 3>;
// What stage states 2 and 3 contribute to the state at the end of the step, and to the mean spin. They need no other rows.
var<private> changes: array<vec3f, 3>;
var<private> momenta: vec3f;
var<private> orientation: vec4f;
// Objects of the same group that the sphere of this thread may touch at all: a bit per id.
var<private> mates: vec2u;
// Those that it may touch as long as no sphere leaves the ball around its reference position.
var<private> near: vec2u;
// Position at which `near` was found, and the squared radius of the ball.
var<private> reference: vec4f;
// The springs of the sphere: the first word of their names, and their number.
var<private> own_springs: vec2u;
// First word of what else is attached to the sphere, and one past the last.
var<private> attached: vec2u;
// The world takes no more steps.
var<private> is_halted: bool;
// Steps one after the other, up to now, at whose end no sphere moved.
var<private> calm: u32;
// Contacts of the sphere in the last step, and the deepest overlap.
var<private> last_contacts: u32;
var<private> last_deepest: f32;

// A word has the names of four springs. A name is the index of a spring, and a bit that is set at its end B.
const SPRING_NAMES: u32 = 4u;
const END_B: u32 = 128u;

fn position_at(sphere: u32) -> u32 {
    return own_rows + sphere;
}

fn velocity_at(sphere: u32) -> u32 {
    return own_rows + WORLD_SPHERES + sphere;
}

// Not used: worlds with low parts of positions do not run here.
fn low_at(sphere: u32) -> u32 {
    return sphere;
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

fn next_row(region: u32, i: u32) -> vec4f {
    return next[region];
}

fn put_next(region: u32, i: u32, row: vec4f) {
    next[region] = row;
}

fn early_changes(region: u32, i: u32, y: vec3f) -> vec3f {
    return changes[region];
}

fn early_momenta(i: u32, start_momentum: vec3f) -> vec3f {
    return momenta;
}

// Asked for in evaluation 3.
fn y4_row(region: u32, i: u32) -> vec4f {
    return state[own_rows + region * WORLD_SPHERES + i];
}

// The next functions do nothing, because these worlds have no rods.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {}

fn add_law_load(i: u32, net: ptr<function, Net>) {}

fn remember(i: u32, old_position: vec3f, spin: vec3f) {}

// Shows rows of the sphere of this thread to the others.
fn show(i: u32, position: vec4f, velocity: vec4f, momentum: vec4f) {
    state[position_at(i)] = position;
    state[velocity_at(i)] = velocity;
    state[momentum_at(i)] = momentum;
}

fn load_status(before: WorldResult) {
    status.steps = before.steps;
    atomicStore(&status.rejected, before.rejected);
    status.total_bad = before.total_bad;
    status.first_bad = before.first_bad;
    status.bad_step = before.bad_step;
    atomicStore(&status.bad_body, NO_BODY);
    atomicStore(&status.bad_count, 0u);
    atomicStore(&status.counters[0].contacts, 0u);
    atomicStore(&status.counters[0].max_overlap, 0u);
    // Near objects are found in the first force evaluation.
    atomicStore(&moved[own_world], 1u);
    atomicStore(&motion[own_world], 0u);
}

// Loads the sphere of this thread.
fn load_sphere(world: u32, i: u32) {
    attached = vec2u(0u);
    own_springs = vec2u(0u);
    last_contacts = 0u;
    last_deepest = 0.0;
    if i >= step.spheres {
        return;
    }
    for (var region = 0u; region < 3u; region++) {
        start[region] = starts[(3u * world + region) * WORLD_SPHERES + i];
    }
    orientation = turns[world * WORLD_SPHERES + i];
    attached = adjacency(i);
    own_springs = vec2u(attached.x & 0xffffu, attached.x >> 16u);
    attached.x = own_springs.x + own_springs.y;
    mates = mates_of(i);
    show(i, start[0], start[1], start[2]);
}

// The bit of an object.
fn bit_of(id: u32) -> vec2u {
    let bit = 1u << (id & 31u);
    return select(vec2u(0u, bit), vec2u(bit, 0u), id < 32u);
}

fn mates_of(i: u32) -> vec2u {
    let group = topology[step.tags_at + i] & GROUP_MASK;
    var found = vec2u(0u);
    for (var id = select(step.spheres, 0u, SPHERE_PAIRS); id < objects(); id++) {
        if (id != i) & ((topology[step.tags_at + id] & GROUP_MASK) == group) {
            found |= bit_of(id);
        }
    }
    return found;
}

// The bits of all spheres. The other bits of the first word are those of static objects.
fn sphere_bits() -> u32 {
    return select((1u << (step.spheres & 31u)) - 1u, ~0u, step.spheres >= 32u);
}

// Radius of the ball in which a sphere may move before the near objects are found again: some room, and the way of a few steps.
fn margin_of(radius: f32, velocity: vec3f) -> f32 {
    return 0.1 * radius + 4.0 * step.dt * length(velocity);
}

// Upper bound of the rounding errors of the distance from a static object, in units. `size` is the sum of all lengths in it.
fn rounding(own: vec3f, size: vec3f) -> f32 {
    let all = abs(own) + size;
    return 1e-6 * (all.x + all.y + all.z);
}

// Whether a static object may be within `reach` of a point.
fn is_static_near(own: vec3f, reach: f32, number: u32) -> bool {
    if number < step.boxes {
        let box = cuboid(number);
        let size = abs(box.corner) + abs(box.i) + abs(box.j) + abs(box.k);
        return !(touch_sphere_box(vec4f(own, reach + rounding(own, size)), box).overlap <= 0.0);
    }
    let face = polygon(number - step.boxes);
    let distance = dot(own - face.corner, normalize(cross(face.left, face.right)));
    return !(abs(distance) > reach + rounding(own, abs(face.corner) + abs(face.left) + abs(face.right)));
}

// Whether another sphere may touch a sphere before one of the two leaves its ball. Comparisons with values that are not finite
// count as near.
fn is_sphere_near(own: vec4f, margin: f32, id: u32) -> bool {
    let other = state[position_at(id)];
    let between = other.xyz - own.xyz;
    let reach = own.w + other.w + margin + margin_of(other.w, state[velocity_at(id)].xyz);
    return !(dot(between, between) > reach * reach);
}

// Finds the objects of the same group that a sphere may touch, at the present positions. Each thread goes through its own bits, so
// that threads with different objects test them at the same time.
fn find_near(i: u32) {
    let own = state[position_at(i)];
    let margin = margin_of(own.w, state[velocity_at(i)].xyz);
    var found = vec2u(0u);
    if SPHERE_PAIRS {
        for (var spheres = mates.x & sphere_bits(); spheres != 0u; spheres &= spheres - 1u) {
            let id = firstTrailingBit(spheres);
            found.x |= select(0u, 1u << id, is_sphere_near(own, margin, id));
        }
    }
    var statics = vec2u(mates.x & ~sphere_bits(), mates.y);
    while any(statics != vec2u(0u)) {
        let id = take_lowest(&statics);
        found |= select(vec2u(0u), bit_of(id), is_static_near(own.xyz, own.w + margin, id - step.spheres));
    }
    near = found;
    // A little less than the square of the margin, because of rounding errors.
    reference = vec4f(own.xyz, 0.98 * margin * margin);
}

// Requests that near objects are found again in the next force evaluation if the sphere has left its ball.
fn check_reference(i: u32, evaluations: u32) {
    let way = state[position_at(i)].xyz - reference.xyz;
    if !(dot(way, way) <= reference.w) {
        atomicStore(&moved[own_world], evaluations + 1u);
    }
}

// Evaluates each spring. `has_new_time` tells whether the rest lengths of muscles change.
fn evaluate_springs(local: u32, has_new_time: bool) {
    let count = springs();
    for (var first = 0u; first < count; first += WORLD_THREADS) {
        let spring = first + local;
        if spring < count {
            let word = word_of_record(step.springs_at, spring, SPRING_WORDS);
            let a = topology[word];
            let b = topology[word + count];
            var constants = spread_vector_at(word + 2u * count, count);
            if step.muscles_at != 0u {
                if has_new_time {
                    lengths[first_spring + spring] = muscle_length(spring, constants.y);
                }
                constants.y = lengths[first_spring + spring];
            }
            let force = spring_force(
                state[position_at(a)].xyz,
                state[velocity_at(a)].xyz,
                state[position_at(b)].xyz,
                state[velocity_at(b)].xyz,
                constants,
            );
            spring_forces[first_spring + spring] = vec4f(force, 0.0);
        }
    }
}

// Takes the lowest bit out of a mask, and returns its number.
fn take_lowest(mask: ptr<function, vec2u>) -> u32 {
    if (*mask).x != 0u {
        let id = firstTrailingBit((*mask).x);
        (*mask).x &= (*mask).x - 1u;
        return id;
    }
    let id = firstTrailingBit((*mask).y);
    (*mask).y &= (*mask).y - 1u;
    return 32u + id;
}

// Those of some spheres that are close to a sphere. The test is that of `close`.
fn close_spheres(own: vec4f, spheres: u32) -> u32 {
    var found = spheres;
    for (var rest = spheres; rest != 0u; rest &= rest - 1u) {
        let id = firstTrailingBit(rest);
        let place = state[position_at(id)];
        let between = place.xyz - own.xyz;
        let reach = own.w + place.w;
        if !(dot(between, between) < SLACK * reach * reach) {
            found &= ~(1u << id);
        }
    }
    return found;
}

fn add_near_contact(i: u32, own: vec4f, side: Side, other: LoadedEntry, net: ptr<function, Net>) {
    let push = push_of(i, NO_ROD, own, side, other);
    (*net).force += push.force;
    (*net).torque = fma(push.torque_per_arm, vec3f(push.arm), (*net).torque);
    count_push(i, other.entry, push, net);
}

fn add_sphere_contacts(i: u32, own: vec4f, side: Side, candidates: u32, net: ptr<function, Net>) {
    var spheres = close_spheres(own, candidates);
    while spheres != 0u {
        add_near_contact(i, own, side, load_entry(firstTrailingBit(spheres), true), net);
        spheres &= spheres - 1u;
    }
}

// Adds the forces of contacts in ascending order of ids, as `add_contacts` does. First come spheres, then static objects, so that
// the threads of a subgroup have objects of the same kind at the same time.
fn add_near_contacts(i: u32, net: ptr<function, Net>) {
    let own = state[position_at(i)];
    let side = sphere_side(own, state[velocity_at(i)], state[momentum_at(i)]);
    if SPHERE_PAIRS {
        add_sphere_contacts(i, own, side, near.x & sphere_bits(), net);
    }
    var statics = vec2u(near.x & ~sphere_bits(), near.y);
    while any(statics != vec2u(0u)) {
        // The rows of a static object are not used.
        let other = LoadedEntry(take_lowest(&statics), vec4f(0.0), vec4f(0.0), vec4f(0.0));
        add_near_contact(i, own, side, other, net);
    }
}

// Adds the force of a spring, given by its name. On end B it is computed from negated vectors in the stages, so it is the same with
// the other sign.
fn add_spring(name: u32, force: vec4f, net: ptr<function, Net>) {
    (*net).force += select(force.xyz, -force.xyz, (name & END_B) != 0u);
}

// Adds the forces of springs in the order of the adjacency. It reads four at once, so that their memory requests overlap. The
// names past the end are those of any springs, which are not added.
fn add_springs(net: ptr<function, Net>) {
    for (var k = 0u; k < own_springs.y; k += SPRING_NAMES) {
        let names = vec4u(topology[own_springs.x + k / SPRING_NAMES]) >> vec4u(0u, 8u, 16u, 24u);
        let springs = vec4u(first_spring) + (names & vec4u(END_B - 1u));
        let force_x = spring_forces[springs.x];
        let force_y = spring_forces[springs.y];
        let force_z = spring_forces[springs.z];
        let force_w = spring_forces[springs.w];
        add_spring(names.x, force_x, net);
        if k + 1u < own_springs.y {
            add_spring(names.y, force_y, net);
        }
        if k + 2u < own_springs.y {
            add_spring(names.z, force_z, net);
        }
        if k + 3u < own_springs.y {
            add_spring(names.w, force_w, net);
        }
    }
}

// Adds the forces of springs, tethers and external forces in the order of the adjacency words.
fn add_attached(i: u32, net: ptr<function, Net>) {
    add_springs(net);
    for (var at = attached.x; at < attached.y; at++) {
        let word = topology[at];
        (*net).force += attached_force(i, kind_of(word), index_of(word));
    }
}

// Turns the sphere by a mean spin during a step.
fn turn_own(spin: vec3f) {
    let by = rotation(spin);
    if any(by.xyz != vec3f(0.0)) {
        orientation = rotated(orientation, by);
    }
}

// Computes the next stage state of a sphere, or its state after the step, from the forces on it.
fn advance_sphere(i: u32, net: Net, is_symplectic_euler: bool) {
    if is_symplectic_euler {
        write_symplectic_euler(i, net);
    } else if evaluated == 3u {
        turn_own(finish_sphere(i, net).spin);
    } else {
        write_next(i, net);
    }
    if evaluated == 0u {
        last_contacts = net.contacts;
        last_deepest = net.deepest;
    }
}

// Whether the sphere of this thread, at the end of a step, is too fast for a world at rest. The same as `Rest::note` on the CPU.
fn is_moving() -> bool {
    let spin = start[2].xyz * start[2].w;
    let most = pass_.rest_speed * pass_.rest_speed;
    let is_slow = dot(start[1].xyz, start[1].xyz) <= most;
    return !(is_slow & (dot(spin, spin) * start[0].w * start[0].w <= most));
}

// Whether all spheres have been at rest for so long that the world stands still.
fn is_asleep() -> bool {
    return (pass_.rest_steps != 0u) & (calm >= pass_.rest_steps) & (step.muscles_at == 0u);
}

// Adds stage state 2 or 3 to the sums. They are those of step/integrate/early_stages.wgsl, in the same order. Twice a number is
// exact.
fn add_stage_state() {
    for (var region = 0u; region < 3u; region++) {
        let change = next[region].xyz - start[region].xyz;
        if evaluated == 0u {
            changes[region] = change;
        } else {
            changes[region] += 2.0 * change;
        }
    }
    momenta = select(momenta, start[2].xyz, evaluated == 0u) + 2.0 * next[2].xyz;
}

// Shows the state whose forces are evaluated next.
fn show_next(i: u32, evaluations: u32, is_symplectic_euler: bool) {
    if is_symplectic_euler {
        commit(i);
        turn_own(next[2].xyz * next[2].w);
    }
    if is_symplectic_euler | (evaluated == 3u) {
        show(i, start[0], start[1], start[2]);
        if is_moving() {
            atomicStore(&motion[own_world], evaluations);
        }
        return;
    }
    show(i, next[0], next[1], next[2]);
    if evaluated < 2u {
        add_stage_state();
    }
}

// Evaluates the forces once. `evaluations` counts the force evaluations of the dispatch, from 1.
fn evaluate(local: u32, evaluations: u32, has_new_time: bool, is_symplectic_euler: bool) {
    let is_active = (local < step.spheres) & !is_halted;
    var has_net = is_active;
    if is_active {
        has_net = (evaluated == 0u) | (inverse_mass(local) > 0.0);
        if atomicLoad(&moved[own_world]) == evaluations {
            find_near(local);
        }
    }
    if !is_halted {
        evaluate_springs(local, has_new_time);
    }
    var net = no_force();
    if has_net {
        add_near_contacts(local, &net);
    }
    workgroupBarrier();
    if has_net {
        add_attached(local, &net);
    }
    if is_active {
        advance_sphere(local, net, is_symplectic_euler);
        show_next(local, evaluations, is_symplectic_euler);
        check_reference(local, evaluations);
    }
    if (local == 0u) & !is_halted & (is_symplectic_euler | (evaluated == 3u)) {
        status.steps += 1u;
    }
    workgroupBarrier();
}

// Notes bodies whose state stopped being finite. They may halt the world.
fn note_bad(local: u32, bad_body: u32) {
    if bad_body == NO_BODY {
        return;
    }
    if local == 0u {
        status.total_bad += atomicLoad(&status.bad_count);
        note_bad_body();
        atomicStore(&status.bad_count, 0u);
        atomicStore(&status.bad_body, NO_BODY);
    }
    is_halted = (step.flags & FLAG_CONTINUE) == 0u;
}

// Step `k` of the dispatch.
fn run_step(k: u32, local: u32, is_symplectic_euler: bool) {
    let evaluations = select(4u, 1u, is_symplectic_euler);
    for (var number = 0u; number < evaluations; number++) {
        evaluated = number;
        // Evaluations 1 and 2 are at the same time, and so are evaluation 3 and evaluation 0 of the next step.
        let has_new_time = is_symplectic_euler | (k == 0u) | ((number & 1u) == 1u);
        evaluate(local, k * evaluations + number + 1u, has_new_time, is_symplectic_euler);
    }
    // The first body whose state stopped being finite in this step, or NO_BODY. All threads read it before one of them changes it.
    let bad_body = atomicLoad(&status.bad_body);
    workgroupBarrier();
    if !is_halted {
        let is_calm = atomicLoad(&motion[own_world]) != (k + 1u) * evaluations;
        calm = select(0u, min(calm, NO_BODY - 1u) + 1u, is_calm);
        note_bad(local, bad_body);
        is_halted |= is_asleep();
    }
}

fn store_world(world: u32, local: u32) {
    if local < step.spheres {
        for (var region = 0u; region < 3u; region++) {
            starts[(3u * world + region) * WORLD_SPHERES + local] = start[region];
        }
        turns[world * WORLD_SPHERES + local] = orientation;
    }
    if local == 0u {
        results[world] = WorldResult(
            status.steps,
            atomicLoad(&status.rejected),
            atomicLoad(&status.counters[0].contacts),
            atomicLoad(&status.counters[0].max_overlap),
            status.total_bad,
            status.first_bad,
            status.bad_step,
            calm,
        );
    }
}

// Sets which world of the workgroup the thread has, and returns its number there.
fn take_place(thread: u32) -> u32 {
    if GROUP_WORLDS == 1u {
        own_world = 0u;
    } else {
        own_world = min(thread / WORLD_SPHERES, GROUP_WORLDS - 1u);
    }
    own_rows = own_world * 3u * WORLD_SPHERES;
    first_spring = own_world * WORLD_SPRINGS;
    return thread - own_world * WORLD_THREADS;
}

@compute @workgroup_size(GROUP_THREADS)
fn run_worlds(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let local = take_place(thread);
    let number = linear_group(group, groups) * GROUP_WORLDS + own_world;
    // There may be more places than worlds, and more threads than spheres. These run no step and store nothing.
    let has_place = (number < arrayLength(&parameters)) & (local < WORLD_THREADS);
    let world = min(number, arrayLength(&parameters) - 1u);
    world_topology = world * WORLD_TOPOLOGY;
    if thread == 0u {
        atomicStore(&awake, 0u);
    }
    if local == 0u {
        world_steps[own_world] = parameters[world];
    }
    workgroupBarrier();
    let before = results[world];
    if local == 0u {
        load_status(before);
    }
    load_sphere(world, local);
    calm = before.calm;
    let was_halted = !has_place | (before.rejected != 0u) | is_asleep();
    is_halted = was_halted;
    if !was_halted {
        atomicStore(&awake, 1u);
    }
    workgroupBarrier();
    // All threads of a workgroup agree on this.
    let count = select(pass_.index >> PHASES_SHIFT, 0u, atomicLoad(&awake) == 0u);
    for (var k = 0u; k < count; k++) {
        run_step(k, local, (pass_.index & SYMPLECTIC_EULER) != 0u);
    }
    if !was_halted {
        atomicAdd(&status.counters[0].contacts, last_contacts);
        atomicMax(&status.counters[0].max_overlap, bitcast<u32>(last_deepest));
    }
    workgroupBarrier();
    // A world that was halted before has not changed.
    if !was_halted {
        store_world(world, local);
    }
}
