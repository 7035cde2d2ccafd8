// requires model/collision_state.wgsl model/order.wgsl model/step.wgsl physics/escape.wgsl physics/motion.wgsl
// requires step/collisions/crossing_rows.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> crossings: array<vec4f>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

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

@compute @workgroup_size(256)
fn commit_crossings(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    // `commit_collisions` sets `collided` to 2 in the attempt that does the collisions.
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) != 2u) {
        return;
    }
    if !has_handled_crossing(i) {
        return;
    }
    apply_crossing(i);
    // A pair of moving spheres is counted once, at the sphere that was added first.
    let row = crossing_row(i);
    if row.is_alone | (ordered(i, row.other).x == i) {
        atomicAdd(&status.counters[linear_group(group, groups) % COUNTER_BLOCKS].collisions, 1u);
    }
}
