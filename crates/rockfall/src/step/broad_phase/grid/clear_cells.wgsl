// requires model/step.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read_write> cells: array<u32>;
@group(0) @binding(3) var<storage, read_write> status: Status;

@compute @workgroup_size(64)
fn clear_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    if block * CELL_BLOCK >= step.cells {
        return;
    }
    let is_due = builds_lists(REBUILD_REQUESTED);
    if (block == 0u) & (local == 0u) {
        cells[1] = u32(is_due);
    }
    if !is_due {
        return;
    }
    if block == 0u {
        for (var k = local + MASK_AT; k < CELLS_AT; k += WORKGROUP) {
            cells[k] = 0u;
        }
    }
    if (block == 0u) & (local == 0u) {
        cells[3] = 0u;
        status.pair_rows_needed = 0u;
    }
    for (var k = local; k < CELL_BLOCK; k += WORKGROUP) {
        cells[CELLS_AT + block * CELL_BLOCK + k] = 0u;
    }
}
