@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
@group(0) @binding(5) var<storage, read_write> status: StatusPairs;

// `Status` where the room for entries is given out.
struct StatusPairs {
    void: atomic<u32>,
    pairs_needed: atomic<u32>,
}

// The longest list of each slice of the workgroup.
var<workgroup> longest: array<atomic<u32>, WORKGROUP / SLICE>;

fn emit(mover: u32, place: u32, entry: u32) {}

@compute @workgroup_size(64)
fn count_neighbours(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    if local < WORKGROUP / SLICE {
        atomicStore(&longest[local], 0u);
    }
    workgroupBarrier();
    var count = 0u;
    if mover < step.spheres + step.rods {
        count = emit_neighbours(mover);
        atomicMax(&longest[local / SLICE], count);
    }
    if mover < step.slices_at {
        lists[mover] = count;
    }
    workgroupBarrier();
    if (local % SLICE == 0u) & (mover < step.slices_at) {
        let words = atomicLoad(&longest[local / SLICE]) * SLICE;
        let offset = atomicAdd(&status.pairs_needed, words);
        lists[step.slices_at + mover / SLICE] = offset;
        if offset + words > step.pair_capacity {
            atomicOr(&status.void, VOID_PAIRS);
        }
        if offset + words < offset {
            atomicOr(&status.void, VOID_COUNT);
        }
    }
}
