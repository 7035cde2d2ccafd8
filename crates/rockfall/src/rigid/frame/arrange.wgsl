// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/gather.wgsl rigid/frame/colours.wgsl

// Blocks in the order of their colours: each workgroup counts its colours, the sums of these counts are places, and each block goes
// there. Where blocks still wait, nothing is arranged; after the last round, `biased` of the call is 1, and they are left over.

// Of each colour the number of blocks in each tile; then their sums.
@group(0) @binding(32) var<storage, read_write> table: array<u32>;

const TILE: u32 = 256u;

var<workgroup> colours_of_tile: array<u32, TILE>;

fn tiles() -> u32 {
    return (arrayLength(&table) - 1u) / (COLOURS + 1u);
}

fn colour_of(k: u32) -> u32 {
    if k >= block_count() {
        return LEFT_OVER + 1u;
    }
    return atomicLoad(&states[k]) & 31u;
}

@compute @workgroup_size(TILE)
fn count_colours(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let tile = group.x + group.y * groups.x;
    if tile >= tiles() {
        return;
    }
    let k = tile * TILE + local;
    colours_of_tile[local] = colour_of(k);
    if k < block_count() && (atomicLoad(&states[k]) & WAITING) != 0u {
        atomicAdd(&counts[8], 1u);
    }
    workgroupBarrier();
    if local <= COLOURS {
        var count = 0u;
        for (var other = 0u; other < TILE; other++) {
            count += u32(colours_of_tile[other] == local);
        }
        table[local * tiles() + tile] = count;
    }
    if tile == 0u && local == 0u {
        table[(COLOURS + 1u) * tiles()] = 0u;
    }
}

@compute @workgroup_size(TILE)
fn arrange(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let tile = group.x + group.y * groups.x;
    if tile >= tiles() {
        return;
    }
    let k = tile * TILE + local;
    let colour = colour_of(k);
    colours_of_tile[local] = colour;
    workgroupBarrier();
    if must_wait() {
        return;
    }
    if tile == 0u && local <= COLOURS + 1u {
        atomicStore(&counts[16u + local], table[local * tiles()]);
    }
    if colour > LEFT_OVER {
        return;
    }
    var place = table[colour * tiles() + tile];
    for (var other = 0u; other < local; other++) {
        place += u32(colours_of_tile[other] == colour);
    }
    let one = raw[BLOCK_ROWS * k];
    let two = raw[BLOCK_ROWS * k + 1u];
    blocks[BLOCK_ROWS * place] = one;
    blocks[BLOCK_ROWS * place + 1u] = vec4u(two.x, two.y | (colour << 16u), two.z, 0u);
    ranks[k] = place;
    let at = PAIR_ROWS * one.z + 1u;
    pairs[at].w = (pairs[at].w & 0x00ffffffu) | (colour << 24u);
}
