// requires model/step.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<u32>;
@group(0) @binding(4) var<storage, read> status: Status;

const BLOCK: u32 = 2u * WORKGROUP;

var<workgroup> keys: array<u32, BLOCK>;
var<workgroup> ids: array<u32, BLOCK>;

// Returns bits that, as an integer, have the order of the float.
fn ordered_bits(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn load(local: u32, place: u32) {
    keys[local] = NONE;
    ids[local] = NONE;
    if place < objects() {
        // Any initial order of the objects will do.
        let is_ordered = (pass_.index != 0u) | (cells[2] == objects());
        let id = select(place, cells[step.sorted_at + place], is_ordered);
        keys[local] = ordered_bits(aabbs[id].min.x);
        ids[local] = id;
    }
}

fn put(local: u32, place: u32) {
    if place < objects() {
        cells[step.sorted_at + place] = ids[local];
    }
}

// Exchanges two keys and their ids unless they are in the given order. Equal keys are ordered by id.
fn exchange(low: u32, high: u32, ascending: bool) {
    let above = (keys[low] > keys[high]) | ((keys[low] == keys[high]) & (ids[low] > ids[high]));
    if above == ascending {
        let key = keys[low];
        let id = ids[low];
        keys[low] = keys[high];
        ids[low] = ids[high];
        keys[high] = key;
        ids[high] = id;
    }
}

// Bitonic sort of a block.
@compute @workgroup_size(64)
fn sort_axis(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let first = linear_group(group, groups) * BLOCK + pass_.index * WORKGROUP;
    if !builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    // In pass 1 the half block before the first block stays as pass 0 left it.
    load(local, first + local);
    load(local + WORKGROUP, first + local + WORKGROUP);
    for (var size = 2u; size <= BLOCK; size *= 2u) {
        for (var apart = size / 2u; apart > 0u; apart /= 2u) {
            workgroupBarrier();
            let low = 2u * local - (local & (apart - 1u));
            exchange(low, low + apart, (low & size) == 0u);
        }
    }
    workgroupBarrier();
    put(local, first + local);
    put(local + WORKGROUP, first + local + WORKGROUP);
}
