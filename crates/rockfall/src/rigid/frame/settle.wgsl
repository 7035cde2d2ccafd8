// requires rigid/frame/rows.wgsl rigid/frame/follow.wgsl rigid/frame/halt.wgsl rigid/frame/report.wgsl

// The end of a frame (docs/physics sections 11.2 and 11.9): momenta after the last relax pass, and the test of margins.

@compute @workgroup_size(THREADS)
fn settle(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body >= frame.bodies || !has_mass(body) {
        return;
    }
    follow(body);
    let at = BODY_ROWS * body;
    if bodies[at + 3u].w > bodies[at + 5u].w {
        atomicAdd(&report[0], 1u);
    }
    if !moves_finitely(body) {
        halt(body);
    }
    if bodies[at + 7u].w > 0.0 {
        atomicAdd(&report[1], 1u);
        atomicMax(&report[2], 0xffffffffu - body);
    }
}
