// requires model/counters.wgsl model/one_state.wgsl model/step.wgsl physics/escape.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(5) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(256)
fn check_drift(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    let place = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    if velocity.w > 0.0 {
        let ratio = escape_ratio(place.xyz, place.w, aabbs[i]);
        if ratio > 0.0 {
            report_escape(ratio);
        }
        request_rebuild(i, place, velocity);
    }
}
