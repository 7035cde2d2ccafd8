// requires model/collision_state.wgsl model/order.wgsl model/step.wgsl model/two_states.wgsl physics/escape.wgsl
// requires physics/motion.wgsl step/collisions/crossing_rows.wgsl step/collisions/rows.wgsl step/commit_next_state.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> crossings: array<vec4f>;
@group(0) @binding(7) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// Writes the state of a sphere after its crossing. The angular momentum does not change.
fn apply_crossing(i: u32) {
    let position = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    let momentum = state[momentum_at(i)];
    let low = low_row(i);
    let pushed = velocity.xyz + crossings[2u * step.spheres + i].xyz;
    var after = displaced(Motion(position.xyz, low, pushed, momentum.xyz), crossings[i].xyz);
    if !is_finite(after) {
        after = stopped(position.xyz, low, 0u, i);
    }
    let new_position = vec4f(after.position, position.w);
    let new_velocity = vec4f(after.velocity, velocity.w);
    request_rebuild(i, new_position, new_velocity);
    state[position_at(i)] = new_position;
    let own_velocity = own_velocity_after(i, new_velocity);
    state[velocity_at(i)] = new_velocity;
    if HALF_STEP {
        state[step.spheres + i] = own_velocity;
    }
    state[momentum_at(i)] = vec4f(after.momentum, momentum.w);
    state[low_at(i)] = vec4f(after.low, 0.0);
}

// Whether this attempt at the step does its collisions. 1: an earlier attempt has applied them. The first thread writes 2, possibly
// before other threads read the word. For them 2 means the same as 0.
fn is_first_attempt() -> bool {
    return (atomicLoad(&status.rejected) == 0u) & (atomicLoad(&status.collided) != 1u);
}

// Commits the next state of a sphere, if a collision may have changed it.
fn commit_change(i: u32) {
    // This test comes first because it excludes nearly all spheres by one word of the lists. Reading the status takes several
    // times as long.
    let takes_part = takes_part_in_any(i);
    if (i != 0u) & !takes_part {
        return;
    }
    if !is_first_attempt() {
        return;
    }
    if i == 0u {
        atomicStore(&status.collided, 2u);
        status.forces_due = 1u;
    }
    if takes_part & (atomicLoad(&status.collides) != 0u) {
        commit_next_state(i, COLLISION_REGIONS);
    }
}

// Applies the crossing of a sphere, if it is handled. A pair of moving spheres is counted once, at the sphere that was added first.
fn commit_crossing(i: u32, workgroup: u32) {
    if !has_handled_crossing(i) {
        return;
    }
    if !is_first_attempt() {
        return;
    }
    apply_crossing(i);
    let row = crossing_row(i);
    if row.is_alone | (ordered(i, row.other).x == i) {
        atomicAdd(&status.counters[workgroup % COUNTER_BLOCKS].collisions, 1u);
    }
}

@compute @workgroup_size(256)
fn commit_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if i < step.spheres {
        commit_change(i);
        if CONTINUOUS {
            commit_crossing(i, linear_group(group, groups));
        }
    }
}
