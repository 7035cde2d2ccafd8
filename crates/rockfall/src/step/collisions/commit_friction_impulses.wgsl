// requires model/step.wgsl model/two_states.wgsl physics/escape.wgsl step/commit_next_state.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(256)
fn commit_friction_impulses(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) != 2u) {
        return;
    }
    commit_next_state(i, STATE_REGIONS);
    request_rebuild(i, next_row(0u, i), next_row(1u, i));
}
