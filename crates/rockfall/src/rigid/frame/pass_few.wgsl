// requires rigid/frame/pass.wgsl

// A pass over all colours from a first one on, each of which has at most a block for each thread of a workgroup. One workgroup has them
// all, so that a pass over few blocks is one dispatch.

const FEW: u32 = 256u;

@compute @workgroup_size(FEW)
fn solve_few(@builtin(local_invocation_index) local: u32) {
    for (var colour = call.colour; colour < COLOURS; colour++) {
        let k = colour_start(colour) + local;
        if k < colour_start(colour + 1u) {
            solve_block(k, call.biased == 1u);
        }
        storageBarrier();
    }
}
