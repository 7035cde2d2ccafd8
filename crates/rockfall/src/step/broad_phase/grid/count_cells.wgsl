// requires model/step.wgsl step/broad_phase/due.wgsl step/broad_phase/grid/cells.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read> status: Status;

// What the objects of a workgroup contribute to the data of the levels: a mask of the levels that have objects, and for each
// level the bits of the largest edge and of the greatest absolute coordinate of a centre. Floats that are not negative have
// the order of their bits.
var<workgroup> mask: atomic<u32>;
var<workgroup> edges: array<atomic<u32>, LEVELS>;
var<workgroup> farthest: array<atomic<u32>, LEVELS>;

fn clear_levels(local: u32) {
    if local == 0u {
        atomicStore(&mask, 0u);
    }
    if local < LEVELS {
        atomicStore(&edges[local], 0u);
        atomicStore(&farthest[local], 0u);
    }
}

// Counts an object in its cell. Adds it to the long movers, in any order, if it is one. Adds it to the data of its level,
// unless every mover tests it separately.
fn count_object(object: u32) {
    let aabb = aabbs[object];
    let level = level_of(aabb);
    let centre = 0.5 * aabb.min + 0.5 * aabb.max;
    let cell = cell_coordinates(centre, level);
    let key = cell_key(cell.x, row_key(cell.y, cell.z, level));
    atomicAdd(&cells[CELLS_AT + key], 1u);
    atomicStore(&cells[step.keys_at + object], key);
    if (object < step.spheres + step.rods) & is_long(aabb) {
        atomicStore(&cells[step.long_at + atomicAdd(&cells[3], 1u)], object);
    }
    if (object < step.spheres + step.rods) | !are_statics_tested_apart() {
        let edge = bitcast<u32>(max(largest_edge(aabb), 0.0));
        let bit = 1u << level;
        if (atomicLoad(&mask) & bit) == 0u {
            atomicOr(&mask, bit);
        }
        if edge > atomicLoad(&edges[level]) {
            atomicMax(&edges[level], edge);
        }
        let out = abs(centre);
        let far = bitcast<u32>(max(out.x, max(out.y, out.z)));
        if far > atomicLoad(&farthest[level]) {
            atomicMax(&farthest[level], far);
        }
    }
}

// Adds the data of the workgroup to that of the levels, after all its objects are counted. Most workgroups have nothing new
// to add, and a read takes less time than an atomic update.
fn record_levels(local: u32) {
    if local == 0u {
        let mine = atomicLoad(&mask);
        if (mine & ~atomicLoad(&cells[MASK_AT])) != 0u {
            atomicOr(&cells[MASK_AT], mine);
        }
    }
    if local < LEVELS {
        let mine = atomicLoad(&edges[local]);
        if mine > 0u {
            if mine > atomicLoad(&cells[EDGES_AT + local]) {
                atomicMax(&cells[EDGES_AT + local], mine);
            }
        }
        let far = atomicLoad(&farthest[local]);
        if far > atomicLoad(&cells[FARTHEST_AT + local]) {
            atomicMax(&cells[FARTHEST_AT + local], far);
        }
    }
}

@compute @workgroup_size(256)
fn count_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !builds_lists(REBUILD_REQUESTED) {
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
