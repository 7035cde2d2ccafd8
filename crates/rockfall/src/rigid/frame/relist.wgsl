// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/gather.wgsl rigid/frame/colours.wgsl

// The lists of the bodies name the blocks by their places, and each body knows how many of its blocks are left over. The last stage of
// the assembly.

@compute @workgroup_size(THREADS)
fn relist(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body >= frame.bodies || must_wait() {
        return;
    }
    let first_left_over = atomicLoad(&counts[16u + LEFT_OVER]);
    var left_over = 0u;
    for (var entry = entries[body]; entry < entries[body + 1u]; entry++) {
        let own = entries[frame.bodies + 1u + entry];
        let place = ranks[own >> 1u];
        entries[frame.bodies + 1u + entry] = 2u * place + (own & 1u);
        left_over += u32(place >= first_left_over);
    }
    bodies[BODY_ROWS * body + 4u].w = f32(left_over);
    // The home is no longer needed.
    bodies[BODY_ROWS * body + 8u].w = 0.0;
}
