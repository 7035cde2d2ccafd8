// requires model/step.wgsl step/broad_phase/grid/count_object.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> status: Status;

@compute @workgroup_size(256)
fn count_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if (status.rebuild == 0u) | (status.rejected != 0u) {
        return;
    }
    let object = wide_thread(group, groups, local);
    clear_levels(local);
    workgroupBarrier();
    if object < objects() {
        count_object(object);
    }
    workgroupBarrier();
    record_levels(local);
}
