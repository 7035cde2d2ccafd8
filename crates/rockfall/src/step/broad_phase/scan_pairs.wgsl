// requires model/put_head.wgsl model/step.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(3) var<storage, read_write> status: Status;

// Threads of the workgroup. A single workgroup scans all slices, so it is as large as WebGPU guarantees.
const SCAN: u32 = 256u;

var<workgroup> sums: array<u32, SCAN>;
var<workgroup> carried: u32;
var<workgroup> due: u32;

// Returns the sum, or the greatest u32 if it overflows. That many rows never fit.
fn add_saturating(a: u32, b: u32) -> u32 {
    let sum = a + b;
    return select(sum, 0xffffffffu, sum < a);
}

// Returns the rows of a slice: the length of its longest list.
fn slice_rows(slice: u32, slices: u32) -> u32 {
    if slice >= slices {
        return 0u;
    }
    var longest = 0u;
    for (var k = 0u; k < SLICE; k++) {
        longest = max(longest, lists[slice][k]);
    }
    return longest;
}

@compute @workgroup_size(256)
fn scan_pairs(@builtin(local_invocation_index) local: u32) {
    let slices = step.slices_at / SLICE;
    if local == 0u {
        carried = 0u;
        due = u32(builds_lists(REBUILD_UNDER_WAY));
    }
    if workgroupUniformLoad(&due) == 0u {
        return;
    }
    for (var base = 0u; base < slices; base += SCAN) {
        let own = slice_rows(base + local, slices);
        sums[local] = own;
        workgroupBarrier();
        for (var reach = 1u; reach < SCAN; reach *= 2u) {
            var left = 0u;
            if local >= reach {
                left = sums[local - reach];
            }
            workgroupBarrier();
            sums[local] = add_saturating(left, sums[local]);
            workgroupBarrier();
        }
        let before = carried;
        var left = 0u;
        if local > 0u {
            left = sums[local - 1u];
        }
        if base + local < slices {
            put_head(step.slices_at + base + local, add_saturating(before, left));
        }
        let chunk_total = sums[SCAN - 1u];
        workgroupBarrier();
        if local == 0u {
            carried = add_saturating(before, chunk_total);
        }
    }
    workgroupBarrier();
    if local == 0u {
        put_head(step.slices_at + slices, carried);
        status.pair_rows_needed = carried;
        // A rebuild that the rejected step before this one had no time to count.
        if (status.rebuild & REBUILD_DONE) != 0u {
            status.builds += 1u;
        }
        status.rebuild = REBUILD_DONE;
        if carried > step.pair_rows {
            status.rejected |= REJECTED_PAIRS;
        }
    }
}
