// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl

// Sorts the manifolds of a frame: first by their owner, then each finds its rank among those of the owner. What comes of it does not
// depend on the order in which they were found.

// As `tallies`, while they are counted.
@group(0) @binding(28) var<storage, read_write> tally: array<atomic<u32>>;

@compute @workgroup_size(THREADS)
fn bucket(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let f = thread_of(group, groups, local);
    if f < pair_count(arrayLength(&order)) {
        order[owned[owner_of(found[FOUND_ROWS * f].zw)] + found[FOUND_ROWS * f + 3u].w] = f;
    }
}

fn is_before(one: vec3u, other: vec3u) -> bool {
    if one.x != other.x {
        return one.x < other.x;
    }
    if one.y != other.y {
        return one.y < other.y;
    }
    return one.z < other.z;
}

@compute @workgroup_size(THREADS)
fn rank(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    if p >= pair_count(arrayLength(&order)) {
        return;
    }
    let own = found[FOUND_ROWS * order[p]];
    let owner = owner_of(own.zw);
    let partner = partner_of(own.zw, owner);
    var earlier = 0u;
    var is_first = true;
    for (var q = owned[owner]; q < owned[owner + 1u]; q++) {
        let other = found[FOUND_ROWS * order[q]];
        let its_partner = partner_of(other.zw, owner);
        if is_before(vec3u(its_partner, other.xy), vec3u(partner, own.xy)) {
            earlier++;
            is_first &= its_partner != partner;
        }
    }
    sorted[owned[owner] + earlier] = order[p] | select(0u, FIRST_OF_BLOCK, is_first);
    if is_first {
        let lists_from = frame.bodies + 1u;
        atomicAdd(&tally[owner], 1u);
        atomicAdd(&tally[lists_from + owner], 1u);
        if has_mass(partner) {
            atomicAdd(&tally[lists_from + partner], 1u);
        }
    }
}
