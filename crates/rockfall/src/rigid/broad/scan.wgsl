// requires

// The sums of all earlier words of an array, in place: in tiles, then the sums of all earlier tiles are added.

struct Scan {
    length: u32,
}

@group(0) @binding(23) var<storage, read_write> scanned: array<u32>;
// Of each tile.
@group(0) @binding(24) var<storage, read_write> sums: array<u32>;
@group(0) @binding(25) var<uniform> scan: Scan;

const SCAN_THREADS: u32 = 256u;
// Words of a thread.
const EACH: u32 = 16u;
const TILE: u32 = 4096u;

var<workgroup> partial: array<u32, SCAN_THREADS>;

fn tile_of(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}

@compute @workgroup_size(SCAN_THREADS)
fn scan_tiles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let tile = tile_of(group, groups);
    let first = TILE * tile + EACH * local;
    var own = 0u;
    // Before a barrier all threads go through a loop equally often: drivers do not survive anything else.
    for (var k = first; k < first + EACH; k++) {
        if k < scan.length {
            own += scanned[k];
        }
    }
    var sum = own;
    partial[local] = sum;
    workgroupBarrier();
    for (var step = 1u; step < SCAN_THREADS; step = 2u * step) {
        var before = 0u;
        if local >= step {
            before = partial[local - step];
        }
        workgroupBarrier();
        sum += before;
        partial[local] = sum;
        workgroupBarrier();
    }
    var earlier = sum - own;
    for (var k = first; k < min(first + EACH, scan.length); k++) {
        let value = scanned[k];
        scanned[k] = earlier;
        earlier += value;
    }
    if local == SCAN_THREADS - 1u && TILE * tile < scan.length {
        sums[tile] = sum;
    }
}

@compute @workgroup_size(SCAN_THREADS)
fn add_tiles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let tile = tile_of(group, groups);
    let tiles = min(tile, (scan.length + TILE - 1u) / TILE);
    var sum = 0u;
    for (var round = 0u; round < tiles; round += SCAN_THREADS) {
        if round + local < tiles {
            sum += sums[round + local];
        }
    }
    partial[local] = sum;
    workgroupBarrier();
    for (var half = SCAN_THREADS / 2u; half > 0u; half = half / 2u) {
        if local < half {
            partial[local] += partial[local + half];
        }
        workgroupBarrier();
    }
    let earlier = partial[0];
    for (var k = TILE * tile + local; k < min(TILE * (tile + 1u), scan.length); k += SCAN_THREADS) {
        scanned[k] += earlier;
    }
}
