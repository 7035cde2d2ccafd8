// requires rigid/frame/report.wgsl rigid/frame/rows.wgsl rigid/frame/scratch.wgsl

// After the rounds of impacts of blocks that may have round pairs: whether a block waits (docs/physics section 11.7).

@compute @workgroup_size(THREADS)
fn wait_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k >= frame.blocks {
        return;
    }
    let block = block_at(k);
    let hit = loads[hit_row(k)];
    let waits = atomicLoad(&report[3]) != 0u && hit.x != 0.0 && may_wait(hit);
    blocks[BLOCK_ROWS * k + 1u].y = select(block.info & ~WAITS, block.info | WAITS, waits);
    for (var pair = block.first_pair; waits && pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        for (var point = face.first; point < face.first + room_of(face); point++) {
            contacts[2u * point + 1u] = vec4f(0.0);
        }
    }
}

// Whether any block is hit at the start of a substep. If none is, there are no impacts in it.
@compute @workgroup_size(THREADS)
fn seek_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks && loads[hit_row(k)].x > 0.0 {
        atomicStore(&report[7], 1u);
    }
}
