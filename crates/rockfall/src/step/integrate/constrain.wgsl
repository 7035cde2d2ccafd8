// requires model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/fine.wgsl physics/lengths.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> y3: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> status: Status;

// Corrects the length of a rod along its old direction, in positions and velocities (SHAKE). Returns the relative error
// before the correction. The ends move to x1 + g w1 d_old and x2 - g w2 d_old, so with W = w1 + w2 their new difference is
// d - g W d_old. Its square must be l², which gives A g² - 2 B g + C = 0. The smaller root is the right one.
fn shake(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    let w1 = inverse_mass(ends.x);
    let w2 = inverse_mass(ends.y);
    let sum = w1 + w2;
    if sum <= 0.0 {
        return 0.0;
    }
    let target_length = rod_length(rod);
    let old = y3[position_at(ends.y)].xyz - y3[position_at(ends.x)].xyz;
    let one = state[position_at(ends.x)].xyz;
    let two = state[position_at(ends.y)].xyz;
    let d = between(ends.x, ends.y);
    let a = sum * sum * dot(old, old);
    let b = sum * dot(d, old);
    let c = dot(d, d) - target_length * target_length;
    let discriminant = b * b - a * c;
    if !((discriminant >= 0.0) & (b > 0.0)) {
        // The rod has turned too far in one step.
        return restore_length(rod);
    }
    let correction = old * (c / (b + sqrt(discriminant)));
    let kick = correction / step.dt;
    move_end(ends.x, w1, correction);
    move_end(ends.y, -w2, correction);
    change_end_velocity(ends.x, w1, kick);
    change_end_velocity(ends.y, -w2, kick);
    return without_rounding(length(d) - target_length, one, two) / target_length;
}

// Corrects the length of a rod in positions, and after the integration also in velocities.
fn correct_length(rod: u32, restores: bool) -> f32 {
    if restores {
        return restore_length(rod);
    }
    return shake(rod);
}

// Sets the relative velocity of the ends along the rod to 0 (RATTLE). Returns the relative change of length that it would
// have caused in a step. The surface velocity of a fixed end counts as 0.
fn rattle(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    let v1 = state[velocity_at(ends.x)];
    let v2 = state[velocity_at(ends.y)];
    let sum = v1.w + v2.w;
    if sum <= 0.0 {
        return 0.0;
    }
    let d = between(ends.x, ends.y);
    let squared = dot(d, d);
    var n = vec3f(0.0, 1.0, 0.0);
    if squared > TINY {
        n = d / sqrt(squared);
    }
    let moves_1 = select(vec3f(0.0), v1.xyz, v1.w > 0.0);
    let moves_2 = select(vec3f(0.0), v2.xyz, v2.w > 0.0);
    let opening = dot(moves_2 - moves_1, n);
    let impulse = n * (opening / sum);
    change_end_velocity(ends.x, v1.w, impulse);
    change_end_velocity(ends.y, -v2.w, impulse);
    return without_rounding(opening, moves_1, moves_2) * step.dt / rod_length(rod);
}

@compute @workgroup_size(64)
fn constrain(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_group(group, groups);
    let restores = pass_.index == RESTORING;
    if (index >= step.batches) | (status.rejected != 0u) | (restores & (status.lengths_due == 0u)) {
        return;
    }
    let batch = batch_at(index);
    start_sweeps(local);
    // Stage 0 sweeps the positions until they have converged, stage 1 the velocities.
    let stages = select(2u, 1u, restores);
    for (var stage = 0u; stage < stages; stage++) {
        for (var sweeps = 1u; ; sweeps++) {
            var error = 0.0;
            for (var colour = 0u; colour < batch.colours; colour++) {
                let end = topology[batch.at + colour + 1u];
                for (var k = topology[batch.at + colour] + local; k < end; k += WORKGROUP) {
                    if stage == 0u {
                        error = max(error, correct_length(topology[k], restores));
                    } else {
                        error = max(error, rattle(topology[k]));
                    }
                }
                storageBarrier();
            }
            if !sweep_again(local, error, sweeps, batch.colours) {
                break;
            }
        }
    }
}
