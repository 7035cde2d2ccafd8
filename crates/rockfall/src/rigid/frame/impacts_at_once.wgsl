// requires rigid/frame/rows.wgsl rigid/frame/follow.wgsl rigid/frame/carry.wgsl rigid/frame/left_over_impacts.wgsl rigid/frame/group.wgsl

// The impacts of a substep in one workgroup (docs/physics.md section 11.7): few blocks are hit in most substeps.

const IMPACT_ROUNDS: u32 = 2u;

// Whether a block was reflected.
var<workgroup> struck: atomic<u32>;

fn strike_left_over_at_once(local: u32) {
    for (var k = frame.left_over + local; k < frame.blocks; k += GROUP) {
        find_copies(k);
    }
    storageBarrier();
    for (var body = local; body < frame.bodies; body += GROUP) {
        count_hits(body);
    }
    storageBarrier();
    for (var k = frame.left_over + local; k < frame.blocks; k += GROUP) {
        if strike_copies(k) {
            atomicStore(&struck, 1u);
        }
    }
    storageBarrier();
    for (var body = local; body < frame.bodies; body += GROUP) {
        take_impacts(body);
    }
    storageBarrier();
}

fn strike_all_at_once(local: u32) {
    if local == 0u {
        atomicStore(&struck, 0u);
    }
    for (var body = local; body < frame.bodies; body += GROUP) {
        if has_mass(body) {
            follow(body);
        }
    }
    workgroupBarrier();
    storageBarrier();
    for (var round = 0u; round < IMPACT_ROUNDS; round++) {
        for (var colour = 0u; colour < COLOURS; colour++) {
            let end = colour_start(colour + 1u);
            if colour_start(colour) < end {
                for (var k = colour_start(colour) + local; k < end; k += GROUP) {
                    if strike_block(k) {
                        atomicStore(&struck, 1u);
                    }
                }
                storageBarrier();
            }
        }
        if frame.left_over < frame.blocks {
            strike_left_over_at_once(local);
        }
    }
    workgroupBarrier();
    let any_reflected = atomicLoad(&struck) != 0u;
    for (var k = local; k < frame.blocks; k += GROUP) {
        carry_block(k, any_reflected);
    }
}

@compute @workgroup_size(GROUP)
fn impacts_at_once(@builtin(local_invocation_index) local: u32) {
    strike_all_at_once(local);
}
