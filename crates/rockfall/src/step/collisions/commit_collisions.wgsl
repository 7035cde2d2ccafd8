// requires model/collision_state.wgsl model/step.wgsl model/two_states.wgsl step/collisions/collided.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(256)
fn commit_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if i < step.spheres {
        commit_change(i);
    }
}
