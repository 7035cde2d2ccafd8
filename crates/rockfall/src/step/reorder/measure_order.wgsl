// requires model/entries.wgsl model/lists.wgsl model/step.wgsl

@group(0) @binding(2) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(3) var<storage, read_write> status: StatusAtomic;

var<workgroup> group_entries: atomic<u32>;
var<workgroup> group_digits: atomic<u32>;

// Adds up the number of binary digits of the distances in memory between a sphere and the spheres in its list.
fn measure(i: u32) {
    let first = first_of(i);
    let count = count_of(i);
    var entries = 0u;
    var digits = 0u;
    for (var e = 0u; e < count; e++) {
        let id = entry_id(entry_at(slot_at(first, e)));
        if id < step.spheres {
            entries += 1u;
            digits += 32u - countLeadingZeros(max(i, id) - min(i, id));
        }
    }
    atomicAdd(&group_entries, entries);
    atomicAdd(&group_digits, digits);
}

@compute @workgroup_size(64)
fn measure_order(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if local == 0u {
        atomicStore(&group_entries, 0u);
        atomicStore(&group_digits, 0u);
    }
    workgroupBarrier();
    let sampled = i % (1u + step.spheres / ORDER_SAMPLE) == 0u;
    if (i < step.spheres) & sampled & (atomicLoad(&status.rejected) == 0u) {
        measure(i);
    }
    workgroupBarrier();
    if local == 0u {
        let entries = atomicLoad(&group_entries);
        if entries > 0u {
            atomicAdd(&status.order_entries, entries);
            atomicAdd(&status.order_digits, atomicLoad(&group_digits));
        }
    }
}
