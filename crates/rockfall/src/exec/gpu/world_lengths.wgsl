// Writes rest lengths of springs to the topologies of worlds, and wakes these worlds up (world_lengths.rs).

struct Sizes {
    // Rows of the table.
    rows: u32,
    // Words of a row.
    width: u32,
    // Words of the topology of a world.
    topology: u32,
}

// Words of a row before the lengths: the world, the place of its lengths in its topology, and their number.
const HEAD: u32 = 3u;
// Words of the result of a world, and the word with the number of steps without motion.
const RESULT: u32 = 8u;
const CALM: u32 = 7u;

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var<storage, read> table: array<u32>;
@group(0) @binding(2) var<storage, read_write> topologies: array<u32>;
@group(0) @binding(3) var<storage, read_write> results: array<u32>;

@compute @workgroup_size(256)
fn write_lengths(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let lengths = sizes.width - HEAD;
    let thread = (group.y * groups.x + group.x) * 256u + local;
    let row = thread / lengths;
    if row >= sizes.rows {
        return;
    }
    let first = row * sizes.width;
    let place = thread % lengths;
    let world = table[first];
    if place < table[first + 2u] {
        topologies[world * sizes.topology + table[first + 1u] + place] = table[first + HEAD + place];
    }
    if place == 0u {
        results[world * RESULT + CALM] = 0u;
    }
}
