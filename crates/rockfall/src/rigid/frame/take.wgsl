// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/gather.wgsl rigid/frame/colours.wgsl

// A round: a block takes the smallest free colour if no earlier neighbour waits. What is taken in this round counts as absent, so that
// nothing depends on the time at which it is seen. The first word of the call is the round, from 1 on.

// Whether the neighbour j of k has its turn before k.
fn is_earlier(j: u32, k: u32) -> bool {
    return ranks[j] < ranks[k] || (ranks[j] == ranks[k] && j < k);
}

// The colours of the other blocks of a body as bits; bit 31 if an earlier one waits.
fn used_by(body: u32, k: u32) -> u32 {
    var used = 0u;
    if !has_mass(body) {
        return used;
    }
    for (var entry = list_start(body); entry < list_start(body + 1u); entry++) {
        let j = entries[frame.bodies + 1u + entry] >> 1u;
        if j == k {
            continue;
        }
        let state = atomicLoad(&states[j]);
        if (state & WAITING) != 0u || (state >> 16u) == call.colour {
            used |= select(0u, 0x80000000u, is_earlier(j, k));
        } else {
            used |= 1u << (state & 31u);
        }
    }
    return used;
}

@compute @workgroup_size(THREADS)
fn take(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k >= block_count() || (atomicLoad(&states[k]) & WAITING) == 0u {
        return;
    }
    let both = raw[BLOCK_ROWS * k].xy;
    let used = used_by(both.x, k) | used_by(both.y, k);
    if used < 0x80000000u {
        atomicStore(&states[k], min(countTrailingZeros(~used), LEFT_OVER) | (call.colour << 16u));
    }
}
