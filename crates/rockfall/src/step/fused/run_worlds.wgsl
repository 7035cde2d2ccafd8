// requires model/objects.wgsl model/step.wgsl physics/forces/load.wgsl physics/forces/net_force.wgsl
// requires physics/rotation.wgsl step/fused/world_contacts.wgsl step/fused/world_memory.wgsl step/fused/world_springs.wgsl
// requires step/integrate/close_step.wgsl step/integrate/finished.wgsl step/integrate/next_state.wgsl
// requires step/integrate/symplectic_euler_state.wgsl

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

var<private> orientation: vec4f;
// The world takes no more steps.
var<private> is_halted: bool;
// Steps one after the other, up to now, at whose end no sphere moved.
var<private> calm: u32;
// Contacts of the sphere in the last step, and the deepest overlap.
var<private> last_contacts: u32;
var<private> last_deepest: f32;

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
    for (var region = 0u; region < 4u; region++) {
        start[region] = starts[(4u * world + region) * WORLD_SPHERES + i];
    }
    orientation = turns[world * WORLD_SPHERES + i];
    attached = adjacency(i);
    own_springs = vec2u(attached.x & 0xffffu, attached.x >> 16u);
    attached.x = own_springs.x + own_springs.y;
    mates = mates_of(i);
    show(i, start[0], start[1], start[2]);
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
    let load = Load(net.force, net.torque);
    if is_symplectic_euler {
        turn_own(symplectic_euler_sphere(i, load));
    } else if evaluated == 3u {
        turn_own(finish_sphere(i, load).spin);
    } else {
        write_next(i, load);
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
    for (var region = 1u; region < 3u; region++) {
        let change = next[region].xyz - start[region].xyz;
        if evaluated == 0u {
            changes[region] = change;
        } else {
            changes[region] += 2.0 * change;
        }
    }
    momenta = select(momenta, start[2].xyz, evaluated == 0u) + 2.0 * next[2].xyz;
    velocities = select(velocities, vec3f(0.0), evaluated == 0u) + 2.0 * (next[1].xyz - start[1].xyz);
}

// Shows the state whose forces are evaluated next.
fn show_next(i: u32, evaluations: u32, is_symplectic_euler: bool) {
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
        for (var region = 0u; region < 4u; region++) {
            starts[(4u * world + region) * WORLD_SPHERES + local] = start[region];
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
    own_world = min(thread / WORLD_SPHERES, GROUP_WORLDS - 1u);
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
    // There may be more places than worlds, and threads that belong to no place. These run no step and store nothing.
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
    let count = select(pass_.index >> STEPS_SHIFT, 0u, atomicLoad(&awake) == 0u);
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
