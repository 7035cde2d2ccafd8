// requires rigid/frame/rows.wgsl rigid/frame/pass.wgsl rigid/frame/left_over.wgsl rigid/frame/group.wgsl

// A pass over the blocks of all colours, and the left-over ones, in one workgroup (docs/physics.md section 11.6).

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
