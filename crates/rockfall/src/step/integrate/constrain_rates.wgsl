// requires model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/lengths.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> evaluated: array<vec4f>;
@group(0) @binding(4) var<storage, read> start: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> status: Status;

// The velocity that moves a sphere's centre. That of a fixed sphere is the velocity of its surface.
fn centre_velocity(row: vec4f) -> vec3f {
    return select(vec3f(0.0), row.xyz, row.w > 0.0);
}

// Changes the velocities of the ends along the rod of the evaluated state, so that the rates of the stage keep the length:
// d.(a2 - a1) + q.q = 0. `time` is the time by which the rates were multiplied. Returns the relative change of length that the
// wrong velocity would have caused in a step.
fn hold(rod: u32, time: f32) -> f32 {
    let ends = rod_ends(rod);
    let one = state[velocity_at(ends.x)];
    let two = state[velocity_at(ends.y)];
    let sum = one.w + two.w;
    let d = evaluated[position_at(ends.y)].xyz - evaluated[position_at(ends.x)].xyz;
    let squared = dot(d, d);
    if (sum <= 0.0) | (squared <= TINY) {
        return 0.0;
    }
    let q = centre_velocity(evaluated[velocity_at(ends.y)]) - centre_velocity(evaluated[velocity_at(ends.x)]);
    let before = centre_velocity(start[velocity_at(ends.y)]) - centre_velocity(start[velocity_at(ends.x)]);
    let v1 = centre_velocity(one);
    let v2 = centre_velocity(two);
    let excess = dot(d, v2 - v1 - before) + time * dot(q, q);
    let impulse = d * (excess / (sum * squared));
    change_end_velocity(ends.x, one.w, impulse);
    change_end_velocity(ends.y, -two.w, impulse);
    return without_rounding(excess / sqrt(squared), v1, v2) * step.dt / rod_length(rod);
}

@compute @workgroup_size(64)
fn constrain_rates(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_group(group, groups);
    if (index >= step.batches) | (status.rejected != 0u) {
        return;
    }
    let batch = batch_at(index);
    let time = step.dt * select(0.5, 1.0, pass_.index == 2u);
    start_sweeps(local);
    for (var sweeps = 1u; ; sweeps++) {
        var error = 0.0;
        for (var colour = 0u; colour < batch.colours; colour++) {
            let end = topology[batch.at + colour + 1u];
            for (var k = topology[batch.at + colour] + local; k < end; k += WORKGROUP) {
                error = max(error, hold(topology[k], time));
            }
            storageBarrier();
        }
        if !sweep_again(local, error, sweeps, batch.colours) {
            break;
        }
    }
}
