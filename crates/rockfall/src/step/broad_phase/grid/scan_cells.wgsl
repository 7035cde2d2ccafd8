// requires model/step.wgsl step/broad_phase/due.wgsl step/broad_phase/grid/scan.wgsl

// Four cells per row. Neighbouring threads read and write neighbouring rows.
@group(0) @binding(2) var<storage, read_write> cells: array<vec4u>;
@group(0) @binding(3) var<storage, read> status: Status;

// Threads of the workgroup of a block, and the number of rows of the block that each thread works on.
const GROUP_SIZE: u32 = 256u;
const TILES: u32 = CELL_BLOCK / (4u * GROUP_SIZE);

fn total(row: vec4u) -> u32 {
    return row.x + row.y + row.z + row.w;
}

fn first_row(block: u32) -> u32 {
    return (CELLS_AT + block * CELL_BLOCK) / 4u;
}

// Returns the row of the sum of a block, which is the first word of the row. So no two blocks write to the same row.
fn sum_row(block: u32) -> u32 {
    return (step.sums_at + block * SUM_WORDS) / 4u;
}

@compute @workgroup_size(256)
fn sum_blocks(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    // This condition is uniform across the workgroup.
    if !builds_lists(REBUILD_REQUESTED) | (block * CELL_BLOCK >= step.cells) {
        return;
    }
    var own = vec4u(0u);
    for (var tile = 0u; tile < TILES; tile++) {
        own += cells[first_row(block) + tile * GROUP_SIZE + local];
    }
    sums[local] = total(own);
    scan_sums(local);
    if local == GROUP_SIZE - 1u {
        cells[sum_row(block)] = vec4u(sums[local], 0u, 0u, 0u);
    }
}

// Returns the number of objects in all blocks before one. Every block adds up the sums itself, which takes less time than
// another dispatch.
fn sum_before(block: u32, local: u32) -> u32 {
    var sum = 0u;
    for (var k = local; k < block; k += GROUP_SIZE) {
        sum += cells[sum_row(k)].x;
    }
    sums[local] = sum;
    scan_sums(local);
    let all = sums[GROUP_SIZE - 1u];
    workgroupBarrier();
    return all;
}

@compute @workgroup_size(256)
fn place_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = linear_group(group, groups);
    if !builds_lists(REBUILD_REQUESTED) | (block * CELL_BLOCK >= step.cells) {
        return;
    }
    var before = sum_before(block, local);
    for (var tile = 0u; tile < TILES; tile++) {
        let at = first_row(block) + tile * GROUP_SIZE + local;
        let counts = cells[at];
        sums[local] = total(counts);
        scan_sums(local);
        let own = before + sums[local] - total(counts);
        cells[at] = vec4u(own) + vec4u(0u, counts.x, counts.x + counts.y, counts.x + counts.y + counts.z);
        before += sums[GROUP_SIZE - 1u];
        workgroupBarrier();
    }
}
