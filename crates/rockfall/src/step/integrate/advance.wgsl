// requires model/load_rows.wgsl model/one_state.wgsl model/put_next.wgsl model/step.wgsl step/integrate/next_state.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> start: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

fn start_row(region: u32, i: u32) -> vec4f {
    return start[region * step.spheres + i];
}

@compute @workgroup_size(256)
fn advance(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i < step.spheres) & (atomicLoad(&status.rejected) == 0u) {
        write_next(i, load_of(i));
    }
}
