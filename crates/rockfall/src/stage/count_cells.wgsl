@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> status: Status;

var<workgroup> levels: atomic<u32>;

@compute @workgroup_size(64)
fn count_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if (status.rebuild == 0u) | (status.void != 0u) {
        return;
    }
    let object = linear_thread(group, groups, local);
    if local == 0u {
        atomicStore(&levels, 0u);
    }
    workgroupBarrier();
    if object < step.spheres + step.rods + step.boxes + step.polygons {
        let aabb = aabbs[object];
        let level = level_of(aabb);
        let cell = cell_coordinates(0.5 * aabb.min + 0.5 * aabb.max, level);
        let key = cell_key(cell.x, row_key(cell.y, cell.z, level));
        atomicOr(&levels, 1u << level);
        atomicAdd(&cells[CELLS_AT + key], 1u);
        atomicStore(&cells[step.keys_at + object], key);
    }
    workgroupBarrier();
    if local == 0u {
        // Most workgroups find their levels there already.
        let mine = atomicLoad(&levels);
        if (mine & ~atomicLoad(&cells[0])) != 0u {
            atomicOr(&cells[0], mine);
        }
    }
}
