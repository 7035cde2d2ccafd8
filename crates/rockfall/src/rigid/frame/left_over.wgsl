// requires rigid/frame/rows.wgsl rigid/frame/sweeps.wgsl rigid/frame/warm_start.wgsl

// Left-over blocks (docs/physics section 11.6): each solves copies of its bodies, and each body takes the mean of its copies.

fn copied(mass: Mass, share: f32) -> Mass {
    return Mass(share * mass.inverse, share * mass.diagonal, share * mass.beside);
}

fn solve_copies(k: u32, biased: bool) {
    let block = block_at(k);
    let a = motion_of(block.a);
    let b = motion_of(block.b);
    var sides = Sides(
        a, b, copied(mass_of(block.a), share_of(block.a)), copied(mass_of(block.b), share_of(block.b)),
        between(block.a, block.b)
    );
    sweep_block(block, &sides, biased);
    let at = LOAD_ROWS * frame.blocks + COPY_ROWS * (k - frame.left_over);
    loads[at] = vec4f(sides.a.velocity - a.velocity, 0.0);
    loads[at + 1u] = vec4f(sides.a.spin - a.spin, 0.0);
    loads[at + 2u] = vec4f(sides.b.velocity - b.velocity, 0.0);
    loads[at + 3u] = vec4f(sides.b.spin - b.spin, 0.0);
    if !biased {
        put_load(k, block);
    }
}

fn take_mean(body: u32) {
    let share = share_of(body);
    if !has_mass(body) || share == 0.0 {
        return;
    }
    var motion = motion_of(body);
    let end = lists[body + 1u];
    for (var entry = lists[body]; entry < end; entry++) {
        let own = lists[frame.bodies + 1u + entry];
        if (own >> 1u) >= frame.left_over {
            let at = LOAD_ROWS * frame.blocks + COPY_ROWS * ((own >> 1u) - frame.left_over) + 2u * (own & 1u);
            motion.velocity += (1.0 / share) * loads[at].xyz;
            motion.spin += (1.0 / share) * loads[at + 1u].xyz;
        }
    }
    put_motion(body, motion);
}

@compute @workgroup_size(THREADS)
fn solve_left_over(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = frame.left_over + thread_of(group, groups, local);
    if k < frame.blocks {
        solve_copies(k, call.biased == 1u);
    }
}

@compute @workgroup_size(THREADS)
fn mean(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies {
        take_mean(body);
    }
}
