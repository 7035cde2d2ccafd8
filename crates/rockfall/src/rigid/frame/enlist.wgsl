// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/gather.wgsl

// The starts of the lists, and the blocks of others in the order of their owners.

@compute @workgroup_size(THREADS)
fn enlist(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k <= frame.bodies {
        entries[k] = list_start(k);
    }
    if k >= block_count() {
        return;
    }
    let both = raw[BLOCK_ROWS * k].xy;
    let partner = partner_of(both, owner_of(both));
    if !has_mass(partner) {
        return;
    }
    let start = others_start(partner);
    var earlier = 0u;
    for (var entry = start; entry < list_start(partner + 1u); entry++) {
        earlier += u32(entries[unordered_at(entry)] < k);
    }
    entries[frame.bodies + 1u + start + earlier] = 2u * k + u32(partner == both.y);
}
