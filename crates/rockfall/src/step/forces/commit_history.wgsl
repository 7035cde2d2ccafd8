// requires model/step.wgsl

@group(0) @binding(2) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(64)
fn commit_history(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let row = linear_thread(group, groups, local);
    let movers = step.spheres + step.rods;
    if (row >= movers) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    let before = 2u * row * step.history_room;
    let after = 2u * (movers + row) * step.history_room;
    for (var at = 0u; at < 2u * step.history_room; at += 2u) {
        let last = histories[after + at + 1u];
        histories[before + at] = histories[after + at];
        histories[before + at + 1u] = last;
        if last.w == NO_KEY {
            break;
        }
    }
}
