// requires rigid/frame/rows.wgsl rigid/frame/follow.wgsl rigid/frame/carry.wgsl rigid/frame/left_over_impacts.wgsl rigid/frame/report.wgsl

// The impacts of a substep (docs/physics section 11.7), a dispatch for each colour and round.

// Momenta after the last relax pass, before impacts use them.
@compute @workgroup_size(THREADS)
fn before_impacts(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body == 0u {
        atomicStore(&report[3], 0u);
    }
    if body < frame.bodies && has_mass(body) {
        follow(body);
    }
}

@compute @workgroup_size(THREADS)
fn strike(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = colour_start(call.colour) + thread_of(group, groups, local);
    if k < colour_start(call.colour + 1u) && strike_block(k) {
        atomicStore(&report[3], 1u);
    }
}

@compute @workgroup_size(THREADS)
fn carry(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        carry_block(k, atomicLoad(&report[3]) != 0u);
    }
}

@compute @workgroup_size(THREADS)
fn find_left_over(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = frame.left_over + thread_of(group, groups, local);
    if k < frame.blocks {
        find_copies(k);
    }
}

@compute @workgroup_size(THREADS)
fn count_left_over(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies {
        count_hits(body);
    }
}

@compute @workgroup_size(THREADS)
fn strike_left_over(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = frame.left_over + thread_of(group, groups, local);
    if k < frame.blocks && strike_copies(k) {
        atomicStore(&report[3], 1u);
    }
}

@compute @workgroup_size(THREADS)
fn mean_of_impacts(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies {
        take_impacts(body);
    }
}

// Whether any block is hit at the start of a substep. If none is, there are no impacts in it.
@compute @workgroup_size(THREADS)
fn seek(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks && hit_of(k, block_at(k)).found {
        atomicStore(&report[7], 1u);
    }
}
