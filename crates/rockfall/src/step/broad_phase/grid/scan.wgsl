// Prefix sums over a workgroup of GROUP_SIZE threads. The stage that uses it defines GROUP_SIZE.

var<workgroup> sums: array<u32, GROUP_SIZE>;

// Replaces each element of `sums` by the sum of all elements up to and including it. All threads of the workgroup must call it.
fn scan_sums(local: u32) {
    workgroupBarrier();
    for (var reach = 1u; reach < GROUP_SIZE; reach *= 2u) {
        var left = 0u;
        if local >= reach {
            left = sums[local - reach];
        }
        workgroupBarrier();
        sums[local] += left;
        workgroupBarrier();
    }
}
