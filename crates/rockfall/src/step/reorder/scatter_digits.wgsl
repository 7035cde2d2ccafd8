// requires model/step.wgsl step/reorder/digits.wgsl

@group(0) @binding(2) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> sorted: array<vec2u>;
@group(0) @binding(4) var<storage, read> cells: array<u32>;
@group(0) @binding(5) var<storage, read> status: Status;

@compute @workgroup_size(64)
fn scatter_digits(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    // This condition is uniform across the workgroup.
    if (block * DIGIT_BLOCK >= step.spheres) | (status.rejected != 0u) {
        return;
    }
    count_run(block, local);
    // Replaces each count by a place: after the pairs of lower digits, of earlier blocks and of earlier threads.
    if local < DIGITS {
        var place = cells[digit_at(local, block)];
        for (var at = local * WORKGROUP; at < (local + 1u) * WORKGROUP; at++) {
            let count = counts[at];
            counts[at] = place;
            place += count;
        }
    }
    workgroupBarrier();
    let first = block * DIGIT_BLOCK + local * RUN;
    for (var k = first; k < min(first + RUN, step.spheres); k++) {
        let at = digit_of(pairs[k]) * WORKGROUP + local;
        sorted[counts[at]] = pairs[k];
        counts[at] += 1u;
    }
}
