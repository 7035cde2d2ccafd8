// Sums over a workgroup of GROUP_SIZE threads, which the stage tells.

var<workgroup> sums: array<u32, GROUP_SIZE>;

// Makes `sums` sums of all up to and with each.
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
