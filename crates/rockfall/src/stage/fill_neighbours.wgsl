@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
@group(0) @binding(5) var<storage, read> status: Status;

fn emit(mover: u32, place: u32, entry: u32) {
    lists[step.entries_at + lists[step.slices_at + mover / SLICE] + place * SLICE + mover % SLICE] = entry;
}

@compute @workgroup_size(64)
fn fill_neighbours(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    if (status.void != 0u) | (mover >= step.spheres + step.rods) {
        return;
    }
    emit_neighbours(mover);
}
