@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> status: Status;

fn commit(i: u32) {
    if i >= step.spheres {
        return;
    }
    for (var region = 0u; region < 3u; region++) {
        state[region * step.spheres + i] = next[region * step.spheres + i];
    }
}

@compute @workgroup_size(64)
fn commit_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if (status.void == 0u) & (status.collided == 0u) & (status.collisions > 0u) {
        commit(linear_thread(group, groups, local));
    }
}

@compute @workgroup_size(64)
fn commit_leap(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if status.void == 0u {
        commit(linear_thread(group, groups, local));
    }
}
