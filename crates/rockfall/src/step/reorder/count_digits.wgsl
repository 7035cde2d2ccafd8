// requires model/step.wgsl step/reorder/digits.wgsl

@group(0) @binding(2) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> cells: array<u32>;
@group(0) @binding(4) var<storage, read> status: Status;

@compute @workgroup_size(64)
fn count_digits(
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
    if local < DIGITS {
        var sum = 0u;
        for (var thread = 0u; thread < WORKGROUP; thread++) {
            sum += counts[local * WORKGROUP + thread];
        }
        cells[digit_at(local, block)] = sum;
    }
}
