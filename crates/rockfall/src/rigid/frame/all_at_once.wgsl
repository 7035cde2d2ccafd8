// requires rigid/frame/rows.wgsl rigid/frame/kick.wgsl rigid/frame/pass.wgsl rigid/frame/left_over.wgsl rigid/frame/drift.wgsl rigid/frame/refresh.wgsl rigid/frame/warm_start.wgsl rigid/frame/impacts_at_once.wgsl rigid/frame/group.wgsl

// A frame in one workgroup, but for its end.

fn pass_at_once(biased: bool, local: u32) {
    for (var colour = 0u; colour < COLOURS; colour++) {
        let end = colour_start(colour + 1u);
        if colour_start(colour) < end {
            for (var k = colour_start(colour) + local; k < end; k += GROUP) {
                solve_block(k, biased);
            }
            storageBarrier();
        }
    }
    if frame.left_over < frame.blocks {
        for (var k = frame.left_over + local; k < frame.blocks; k += GROUP) {
            solve_copies(k, biased);
        }
        storageBarrier();
        for (var body = local; body < frame.bodies; body += GROUP) {
            take_mean(body);
        }
        storageBarrier();
    }
}

@compute @workgroup_size(GROUP)
fn all_at_once(@builtin(local_invocation_index) local: u32) {
    for (var k = local; k < frame.blocks; k += GROUP) {
        refresh_block(k);
        put_load(k, block_at(k));
    }
    storageBarrier();
    for (var substep = 0u; substep < frame.substeps; substep++) {
        strike_all_at_once(local);
        storageBarrier();
        for (var body = local; body < frame.bodies; body += GROUP) {
            kick_body(body);
        }
        storageBarrier();
        pass_at_once(true, local);
        for (var body = local; body < frame.bodies; body += GROUP) {
            drift_body(body);
        }
        storageBarrier();
        for (var k = local; k < frame.blocks; k += GROUP) {
            refresh_block(k);
        }
        storageBarrier();
        pass_at_once(false, local);
    }
}
