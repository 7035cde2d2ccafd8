@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> words: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<u32>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(64)
fn commit_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    // 1: done before this attempt at the step; 2, which the first thread writes meanwhile, is as good as 0 here.
    if (i >= step.spheres) | (atomicLoad(&status.void) != 0u) | (atomicLoad(&status.collided) == 1u) {
        return;
    }
    if i == 0u {
        atomicStore(&status.collided, 2u);
    }
    if atomicLoad(&status.collisions) == 0u {
        return;
    }
    if i == 0u {
        status.lengths_due = 1u;
    }
    if takes_part_in_any(i) {
        for (var region = 0u; region < 3u; region++) {
            state[region * step.spheres + i] = next[region * step.spheres + i];
        }
    }
}
