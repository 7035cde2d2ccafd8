// requires model/four_states.wgsl model/step.wgsl model/step_block.wgsl physics/forces/muscle.wgsl
// requires physics/forces/net_force.wgsl physics/rotation.wgsl step/commit.wgsl step/integrate/close_step.wgsl
// requires step/integrate/finished.wgsl step/integrate/next_state.wgsl step/integrate/symplectic_euler_state.wgsl

// Each workgroup advances a world of its own, for many steps. The data of the world are in workgroup memory, under the names
// that the shared files use. So these files compute the same here as in the stages. `step` is a copy of the world's block.

struct WorldResult {
    steps: u32,
    rejected: u32,
    contacts: u32,
    max_overlap: u32,
    total_bad: u32,
    first_bad: u32,
    bad_step: u32,
    pad: u32,
}

@group(0) @binding(2) var<storage, read> parameters: array<Step>;
@group(0) @binding(3) var<storage, read_write> starts: array<vec4f>;
@group(0) @binding(4) var<storage, read> topologies: array<u32>;
@group(0) @binding(5) var<storage, read_write> turns: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> results: array<WorldResult>;

// Room for a world: spheres, entries of a list, and words of topology. The host replaces these numbers by those of the largest
// world in the batch (`WorldSizes`), because a device runs more worlds at a time if each takes less memory. These are the largest
// numbers, with which all arrays together take less than 16 KiB.
const WORLD_SPHERES: u32 = 32u;
const WORLD_ENTRIES: u32 = 36u;
const WORLD_TOPOLOGY: u32 = 896u;
// Threads of a workgroup, one per sphere.
const WORLD_THREADS: u32 = 32u;
// Rows of the lists before the entries: lengths, and the row where the only slice begins.
const HEAD_ROWS: u32 = 2u;

var<workgroup> state: array<vec4f, 12u * WORLD_SPHERES>;
var<workgroup> topology: array<u32, WORLD_TOPOLOGY>;
var<workgroup> lists: array<array<u32, SLICE>, HEAD_ROWS + WORLD_ENTRIES>;
var<workgroup> aabbs: array<Aabb, WORLD_SPHERES>;
var<workgroup> orientations: array<vec4f, WORLD_SPHERES>;
var<workgroup> status: StatusAtomic;

// The next two functions do nothing, because these worlds have no rods.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {}

fn add_law_load(i: u32, net: ptr<function, Net>) {}

fn remember(i: u32, old_position: vec3f, spin: vec3f) {}

fn is_stopped() -> bool {
    return atomicLoad(&status.rejected) != 0u;
}

// Copies a world to workgroup memory.
fn load_world(world: u32, local: u32) {
    for (var word = local; word < WORLD_TOPOLOGY; word += WORLD_THREADS) {
        topology[word] = topologies[world * WORLD_TOPOLOGY + word];
    }
    if local < step.spheres {
        for (var region = 0u; region < 3u; region++) {
            state[region * step.spheres + local] = starts[(3u * world + region) * WORLD_SPHERES + local];
        }
        orientations[local] = turns[world * WORLD_SPHERES + local];
        // Lists hold all pairs, so no sphere leaves its AABB, and no list is rebuilt.
        aabbs[local] = Aabb(vec3f(-3e38), local, vec3f(3e38), 0u);
    }
    if local == 0u {
        let before = results[world];
        status.steps = before.steps;
        atomicStore(&status.rejected, before.rejected);
        status.last_contacts = before.contacts;
        status.last_max_overlap = before.max_overlap;
        status.last_collisions = 0u;
        status.total_collisions_low = 0u;
        status.total_collisions_high = 0u;
        status.total_bad = before.total_bad;
        status.first_bad = before.first_bad;
        status.bad_step = before.bad_step;
        status.clustered_steps = 0u;
        status.many_steps = 0u;
        atomicStore(&status.bad_body, NO_BODY);
        atomicStore(&status.bad_count, 0u);
        atomicStore(&status.rebuild, 0u);
        atomicStore(&status.escape_ratio, 0u);
        atomicStore(&status.collided, 0u);
        atomicStore(&status.collides, 0u);
        atomicStore(&status.listed, 0u);
        atomicStore(&status.clustered, 0u);
        atomicStore(&status.counters[0].contacts, 0u);
        atomicStore(&status.counters[0].max_overlap, 0u);
        atomicStore(&status.counters[0].collisions, 0u);
    }
}

// Lists all objects of the same group for a sphere, in insertion order.
fn list_all(local: u32) {
    if local == 0u {
        lists[1][0] = 0u;
    }
    if local >= step.spheres {
        return;
    }
    let group = topology[step.tags_at + local] & 0xffffu;
    var count = 0u;
    for (var id = 0u; id < objects(); id++) {
        if (id != local) & ((topology[step.tags_at + id] & 0xffffu) == group) {
            lists[HEAD_ROWS + count][local] = id;
            count += 1u;
        }
    }
    lists[0][local] = count;
}

// Writes the present rest lengths of muscles to the springs. The constant lengths stay in `topologies`.
fn flex(world: u32, local: u32) {
    let springs = (step.tethers_at - step.springs_at) / SPRING_WORDS;
    if step.muscles_at == 0u {
        return;
    }
    for (var spring = local; spring < springs; spring += WORLD_THREADS) {
        let word = step.springs_at + spring * SPRING_WORDS + 3u;
        let length = bitcast<f32>(topologies[world * WORLD_TOPOLOGY + word]);
        topology[word] = bitcast<u32>(muscle_length(step.muscles_at + spring * MUSCLE_WORDS, length));
    }
}

// Makes one force evaluation, and computes the next stage state or the state after the step from it.
fn evaluate(local: u32, number: u32, is_symplectic_euler: bool) {
    var contacts = 0u;
    var deepest = 0.0;
    if (local < step.spheres) & !is_stopped() {
        let net = net_in_pass(local);
        if is_symplectic_euler {
            write_symplectic_euler(local, net);
        } else if number == 3u {
            turn_by(local, rotation(finish_sphere(local, net).spin));
        } else {
            write_next(local, net);
        }
        contacts = net.contacts;
        deepest = net.deepest;
    }
    if number == 0u {
        count_contacts_of_workgroup(0u, local, contacts, deepest);
    }
    workgroupBarrier();
}

fn take_symplectic_euler_step(local: u32) {
    if (local < step.spheres) & !is_stopped() {
        commit(local);
        let momentum = next_row(2u, local);
        turn_by(local, rotation(momentum.xyz * momentum.w));
    }
    workgroupBarrier();
}

fn run_step(world: u32, local: u32, is_symplectic_euler: bool) {
    let evaluations = select(4u, 1u, is_symplectic_euler);
    for (var number = 0u; number < evaluations; number++) {
        evaluated = number;
        // Evaluations 1 and 2 are at the same time.
        if number != 2u {
            flex(world, local);
        }
        workgroupBarrier();
        evaluate(local, number, is_symplectic_euler);
    }
    if is_symplectic_euler {
        take_symplectic_euler_step(local);
    }
    close_step(local);
    workgroupBarrier();
}

fn store_world(world: u32, local: u32) {
    if local < step.spheres {
        for (var region = 0u; region < 3u; region++) {
            starts[(3u * world + region) * WORLD_SPHERES + local] = state[region * step.spheres + local];
        }
        turns[world * WORLD_SPHERES + local] = orientations[local];
    }
    if local == 0u {
        results[world] = WorldResult(
            status.steps,
            atomicLoad(&status.rejected),
            status.last_contacts,
            status.last_max_overlap,
            status.total_bad,
            status.first_bad,
            status.bad_step,
            0u,
        );
    }
}

@compute @workgroup_size(WORLD_THREADS)
fn run_worlds(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    // The dispatch may have more workgroups than there are worlds. These repeat nothing: they run no step and store nothing.
    let number = linear_group(group, groups);
    let is_world = number < arrayLength(&parameters);
    let world = select(0u, number, is_world);
    step = parameters[world];
    load_world(world, local);
    workgroupBarrier();
    list_all(local);
    if (local == 0u) & !is_world {
        atomicStore(&status.rejected, REJECTED_NON_FINITE);
    }
    workgroupBarrier();
    let steps = pass_.index >> PHASES_SHIFT;
    for (var k = 0u; k < steps; k++) {
        run_step(world, local, (pass_.index & SYMPLECTIC_EULER) != 0u);
    }
    if is_world {
        store_world(world, local);
    }
}
