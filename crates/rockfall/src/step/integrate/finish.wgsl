// requires model/load_rows.wgsl model/one_state.wgsl model/stage_states.wgsl model/step.wgsl physics/rotation.wgsl
// requires step/integrate/early_stages.wgsl step/integrate/finished.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> y2: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> start: array<vec4f>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(256)
fn finish(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    let done = finish_sphere(i, load_of(i));
    if LATE_TURN {
        y3[position_at(i)] = vec4f(done.old_position, 0.0);
        y3[momentum_at(i)] = vec4f(done.spin, 0.0);
    } else {
        turn_by(i, rotation(done.spin));
    }
}
