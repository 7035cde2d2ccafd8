// requires model/step.wgsl step/broad_phase/grid/count_object.wgsl step/broad_phase/grid/place_object.wgsl
// requires step/broad_phase/grid/scan.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> status: Status;

// Threads of the workgroup. A single workgroup does all the work, so it is as large as WebGPU guarantees.
const GROUP_SIZE: u32 = 256u;
// Cells that a thread sums.
const OWN: u32 = CELL_BLOCK / GROUP_SIZE;

var<workgroup> due: u32;

// Replaces the count of every cell by its start: the number of objects in all cells before it.
fn place_cells(local: u32) {
    let first = CELLS_AT + local * OWN;
    var own = 0u;
    for (var k = 0u; k < OWN; k++) {
        own += atomicLoad(&cells[first + k]);
    }
    sums[local] = own;
    scan_sums(local);
    if local == GROUP_SIZE - 1u {
        for (var k = 0u; k < SUM_WORDS; k++) {
            atomicStore(&cells[step.sums_at + k], select(0u, sums[local], k == 0u));
        }
    }
    var before = sums[local] - own;
    for (var k = 0u; k < OWN; k++) {
        before += atomicExchange(&cells[first + k], before);
    }
}

@compute @workgroup_size(256)
fn build_grid(@builtin(local_invocation_index) local: u32) {
    if local == 0u {
        due = select(0u, status.rebuild, status.rejected == 0u);
        atomicStore(&cells[1], due);
        if due != 0u {
            atomicStore(&cells[0], 0u);
            atomicStore(&cells[3], 0u);
        }
    }
    clear_levels(local);
    if workgroupUniformLoad(&due) == 0u {
        return;
    }
    if local < LEVELS {
        atomicStore(&cells[EDGES_AT + local], 0u);
        atomicStore(&cells[FARTHEST_AT + local], 0u);
    }
    for (var k = local; k < CELL_BLOCK; k += GROUP_SIZE) {
        atomicStore(&cells[CELLS_AT + k], 0u);
    }
    storageBarrier();
    for (var object = local; object < objects(); object += GROUP_SIZE) {
        count_object(object);
    }
    storageBarrier();
    place_cells(local);
    storageBarrier();
    for (var object = local; object < objects(); object += GROUP_SIZE) {
        place_object(object);
    }
    workgroupBarrier();
    record_levels(local);
    if local == 0u {
        status.pair_rows_needed = 0u;
    }
}
