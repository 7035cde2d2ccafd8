// requires model/lists.wgsl model/order.wgsl model/put_head.wgsl model/step.wgsl step/broad_phase/grid/bitonic.wgsl
// requires step/broad_phase/grid/long.wgsl step/broad_phase/grid/neighbours.wgsl step/broad_phase/grid/scan.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read> status: Status;

// Slot of the first entry.
var<private> into: vec2u;
// Number of keys that are found so far.
var<workgroup> found: atomic<u32>;
// Number of keys, once all are found.
var<workgroup> count: u32;

fn emit(mover: u32, place: u32) {
    let entries = entries_found(mover, place);
    if entries == 0u {
        return;
    }
    let id = id_at(place);
    let at = atomicAdd(&found, entries);
    for (var feature = 0u; feature < entries; feature++) {
        lists[into.x + at + feature][into.y] = entry_key(id, feature);
    }
}

// Drops duplicates from the sorted keys, and replaces the keys by entries. Returns the number of entries.
fn drop_duplicates(local: u32) -> u32 {
    let keys = workgroupUniformLoad(&count);
    var kept = 0u;
    var last = NONE;
    for (var first = 0u; first < keys; first += GROUP_SIZE) {
        var key = NONE;
        if first + local < keys {
            key = lists[into.x + first + local][into.y];
        }
        tile[local] = key;
        workgroupBarrier();
        var before = last;
        if local > 0u {
            before = tile[local - 1u];
        }
        let is_kept = (key != NONE) & (key != before);
        sums[local] = u32(is_kept);
        scan_sums(local);
        if is_kept {
            lists[into.x + kept + sums[local] - 1u][into.y] = entry_of(key);
        }
        last = tile[GROUP_SIZE - 1u];
        kept += sums[GROUP_SIZE - 1u];
        workgroupBarrier();
    }
    return kept;
}

@compute @workgroup_size(256)
fn fill_long(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if cells[1] == 0u {
        return;
    }
    let fits = (status.rejected & (REJECTED_PAIRS | REJECTED_COUNT)) == 0u;
    for (var turn = linear_group(group, groups); turn < long_movers(); turn += groups.x * groups.y) {
        let mover = long_mover(turn);
        if local == 0u {
            atomicStore(&found, 0u);
        }
        workgroupBarrier();
        if fits {
            into = first_of(mover);
            emit_neighbours(mover, portion_of_thread(local));
        }
        workgroupBarrier();
        if local == 0u {
            count = atomicLoad(&found);
        }
        order_keys(local);
        let kept = drop_duplicates(local);
        if local == 0u {
            put_head(mover, kept);
        }
    }
}
