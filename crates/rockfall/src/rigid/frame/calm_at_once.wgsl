// requires rigid/frame/rows.wgsl rigid/frame/kick.wgsl rigid/frame/pass_at_once.wgsl rigid/frame/drift.wgsl rigid/frame/refresh.wgsl rigid/frame/warm_start.wgsl rigid/frame/times.wgsl rigid/frame/group.wgsl

// A frame without impacts in one workgroup, but for its end. A block that is hit marks the world as a body that has stopped: then the
// frame begins anew.

@compute @workgroup_size(GROUP)
fn calm_at_once(@builtin(local_invocation_index) local: u32) {
    for (var k = local; k < frame.blocks; k += GROUP) {
        refresh_block(k);
        put_load(k, block_at(k));
    }
    storageBarrier();
    for (var substep = 0u; substep < frame.substeps; substep++) {
        for (var k = local; k < frame.blocks; k += GROUP) {
            if hit_of(k, block_at(k)).found {
                bodies[7].w = 1.0;
            }
        }
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
