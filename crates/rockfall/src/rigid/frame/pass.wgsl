// requires rigid/frame/rows.wgsl rigid/frame/sweeps.wgsl rigid/frame/warm_start.wgsl

// A pass over the blocks of a colour (docs/physics section 11.6). Each thread has a block, and for this dispatch both of its bodies.

fn solve_block(k: u32, biased: bool) {
    let block = block_at(k);
    var sides = Sides(
        motion_of(block.a), motion_of(block.b), mass_of(block.a), mass_of(block.b), between(block.a, block.b)
    );
    if sweep_block(block, &sides, biased) {
        if has_mass(block.a) {
            put_motion(block.a, sides.a);
        }
        if has_mass(block.b) {
            put_motion(block.b, sides.b);
        }
    }
    if !biased {
        put_load(k, block);
    }
}

@compute @workgroup_size(THREADS)
fn solve(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = colour_start(call.colour) + thread_of(group, groups, local);
    if k < colour_start(call.colour + 1u) {
        solve_block(k, call.biased == 1u);
    }
}
