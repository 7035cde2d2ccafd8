@group(0) @binding(2) var<storage, read_write> cells: array<u32>;
@group(0) @binding(3) var<storage, read> status: Status;

// Cells of a thread of a block's workgroup.
const OWN: u32 = CELL_BLOCK / WORKGROUP;

// Threads that share out a block.
const TEAM: u32 = WORKGROUP;

fn own_sum(first: u32) -> u32 {
    var sum = 0u;
    for (var k = 0u; k < OWN; k++) {
        sum += cells[first + k];
    }
    return sum;
}

@compute @workgroup_size(64)
fn sum_blocks(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    // The same for all threads of the workgroup.
    if (status.rebuild == 0u) | (status.void != 0u) | (block * CELL_BLOCK >= step.cells) {
        return;
    }
    sums[local] = own_sum(CELLS_AT + block * CELL_BLOCK + local * OWN);
    scan_sums(local);
    if local == WORKGROUP - 1u {
        cells[step.sums_at + block] = sums[local];
    }
}

// Objects in all blocks before one. Every block adds them up for itself, which takes less time than one more dispatch.
fn sum_before(block: u32, local: u32) -> u32 {
    var sum = 0u;
    for (var k = local; k < block; k += WORKGROUP) {
        sum += cells[step.sums_at + k];
    }
    sums[local] = sum;
    scan_sums(local);
    let all = sums[WORKGROUP - 1u];
    workgroupBarrier();
    return all;
}

@compute @workgroup_size(64)
fn place_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    if (status.rebuild == 0u) | (status.void != 0u) | (block * CELL_BLOCK >= step.cells) {
        return;
    }
    let first = CELLS_AT + block * CELL_BLOCK + local * OWN;
    let all_before = sum_before(block, local);
    let own = own_sum(first);
    sums[local] = own;
    scan_sums(local);
    var before = all_before + sums[local] - own;
    for (var k = 0u; k < OWN; k++) {
        let count = cells[first + k];
        cells[first + k] = before;
        before += count;
    }
}
