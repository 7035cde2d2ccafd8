// requires model/entries.wgsl model/four_states.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl
// requires physics/collision/changes.wgsl physics/forces/net_force.wgsl physics/escape.wgsl physics/rotation.wgsl
// requires step/collisions/collided.wgsl step/collisions/has_changes.wgsl step/collisions/classify_contacts.wgsl
// requires step/collisions/rows.wgsl step/commit.wgsl step/integrate/close_step.wgsl step/integrate/early_stages.wgsl
// requires step/integrate/finished.wgsl
// requires step/integrate/symplectic_euler_state.wgsl step/integrate/next_state.wgsl

@group(0) @binding(2) var<storage, read_write> start: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(7) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// Threads of the workgroup, chosen for the device when the kernel is compiled. Each thread works on every GROUP_SIZE-th
// sphere. All threads make the same number of rounds in a loop: one driver was seen to let threads that leave a loop early
// run through the barrier after it while their neighbours were still in the loop.
override GROUP_SIZE: u32 = 256u;
// Threads of a subgroup on the device with that driver.
const LANES: u32 = 32u;

// The pass index. It is read once and shared, because lavapipe is slow if the uniform block alone decides a branch: see
// "Software Vulkan" in docs/performance.md.
var<workgroup> pass_index: u32;

// The next two functions do nothing, because these scenes have no rods.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {}

fn add_law_load(i: u32, net: ptr<function, Net>) {}

fn remember(i: u32, old_position: vec3f, spin: vec3f) {}

// Where contacts within a step are handled, the single stages replace this kernel.
fn is_put_off(a: u32, b: u32) -> bool {
    return false;
}

// Every sphere computes its collisions itself. If collisions share bodies, the step is rejected, and the single stages
// replace this kernel.
fn part_of_entry(sphere: u32, row: u32, slot: vec2u) -> Part {
    return part_by_itself(sphere, entry_id(entry_at(slot)));
}

fn write_change(i: u32) {
    var change = Change(vec3f(0.0), vec3f(0.0));
    if inverse_mass(i) > 0.0 {
        change = changes_of(i);
    }
    write_changed(i, change);
}

fn is_rejected() -> bool {
    return atomicLoad(&status.rejected) != 0u;
}

fn find_collisions(local: u32) {
    var collisions = 0u;
    if !is_rejected() & (atomicLoad(&status.collided) == 0u) {
        for (var first = 0u; first < step.spheres; first += GROUP_SIZE) {
            let i = first + local;
            if i < step.spheres {
                check_escape(i);
                collisions += mark_entries(i);
            }
        }
    }
    count_collisions_of_workgroup(0u, local, collisions);
}

fn handle_collisions(local: u32) {
    evaluated = 0u;
    find_collisions(local);
    storageBarrier();
    if has_changes() {
        for (var first = 0u; first < step.spheres; first += GROUP_SIZE) {
            let i = first + local;
            // The lanes of a subgroup work one after another. When several lanes ran nested loops of different lengths, the
            // driver named above was seen to let whole subgroups through the barriers below before they had written. This
            // costs little, because few spheres collide in a step.
            for (var lane = 0u; lane < LANES; lane++) {
                if (i < step.spheres) & (local % LANES == lane) {
                    if takes_part_in_any(i) {
                        write_change(i);
                    }
                }
            }
        }
    }
    storageBarrier();
    for (var first = 0u; first < step.spheres; first += GROUP_SIZE) {
        let i = first + local;
        if i < step.spheres {
            commit_change(i);
        }
    }
    storageBarrier();
}

// Makes one force evaluation, and computes the next stage state or the state after the step from it.
fn evaluate(local: u32, evaluation: u32, is_symplectic_euler: bool) {
    evaluated = evaluation;
    var contacts = 0u;
    var deepest = 0.0;
    if !is_rejected() {
        for (var first = 0u; first < step.spheres; first += GROUP_SIZE) {
            let i = first + local;
            if i < step.spheres {
                let net = net_in_pass(i);
                if is_symplectic_euler {
                    write_symplectic_euler(i, net);
                } else if evaluation == 3u {
                    turn_by(i, rotation(finish_sphere(i, net).spin));
                } else {
                    write_next(i, net);
                }
                contacts += net.contacts;
                deepest = max(deepest, net.deepest);
            }
        }
    }
    if evaluation == 0u {
        if (local == 0u) & !is_rejected() {
            count_rebuild();
        }
        count_contacts_of_workgroup(0u, local, contacts, deepest);
    }
}

// Copies the states that symplectic Euler has computed to the current states, and turns the spheres.
fn take_symplectic_euler_steps(local: u32) {
    if is_rejected() {
        return;
    }
    for (var first = 0u; first < step.spheres; first += GROUP_SIZE) {
        let i = first + local;
        if i < step.spheres {
            commit(i);
            let momentum = next_row(2u, i);
            turn_by(i, rotation(momentum.xyz * momentum.w));
        }
    }
}

fn update_positions(local: u32, is_symplectic_euler: bool) {
    let evaluations = select(4u, 1u, is_symplectic_euler);
    for (var evaluation = 0u; evaluation < evaluations; evaluation++) {
        evaluate(local, evaluation, is_symplectic_euler);
        storageBarrier();
    }
    if is_symplectic_euler {
        take_symplectic_euler_steps(local);
        storageBarrier();
    }
    close_step(local);
    storageBarrier();
}

// Returns whether phase k of a dispatch with this pass index is that of collisions.
fn is_collisions(k: u32, index: u32) -> bool {
    let order = index & ORDER_MASK;
    return (order != POSITIONS_ALONE) & ((k + order) % 2u == 0u);
}

// All threads reach every barrier, even if a step is rejected. A rejected step and the steps after it do nothing between the
// barriers.
@compute @workgroup_size(GROUP_SIZE)
fn run_steps(@builtin(local_invocation_index) local: u32) {
    for (var first = 0u; first < 3u * step.spheres; first += GROUP_SIZE) {
        let i = first + local;
        if i < 3u * step.spheres {
            state[i] = start[i];
        }
    }
    storageBarrier();
    if local == 0u {
        pass_index = pass_.index;
    }
    let index = workgroupUniformLoad(&pass_index);
    let count = index >> PHASES_SHIFT;
    for (var k = 0u; k < count; k++) {
        if is_collisions(k, index) {
            handle_collisions(local);
        } else {
            update_positions(local, (index & SYMPLECTIC_EULER) != 0u);
        }
    }
    for (var first = 0u; first < 3u * step.spheres; first += GROUP_SIZE) {
        let i = first + local;
        if i < 3u * step.spheres {
            start[i] = state[i];
        }
    }
}
