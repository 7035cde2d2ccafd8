// Sorts the keys of a list in place, with a workgroup. It is a bitonic sort (Batcher 1968) in which each round first compares
// mirrored places. So all comparators put the lesser key first. The missing keys after the end, which count as
// greater than all others, never move.
//
// The stage that uses it defines `into`, the slot of the first entry, and `count`, the number of keys.

// Keys that are sorted in workgroup memory at a time, and their binary logarithm.
const TILE_BITS: u32 = 11u;
const TILE: u32 = 1u << TILE_BITS;
var<workgroup> tile: array<u32, TILE>;

// Returns the two places of a comparison. They are 2^bits apart or, if mirrored, mirror images in a block of 2^(bits + 1)
// places.
fn places_of(pair: u32, bits: u32, mirrored: bool) -> vec2u {
    let stride = 1u << bits;
    let low = ((pair >> bits) << (bits + 1u)) | (pair & (stride - 1u));
    return vec2u(low, low ^ select(stride, 2u * stride - 1u, mirrored));
}

// Makes the comparisons of one distance on the list.
fn compare_in_list(keys: u32, bits: u32, mirrored: bool, local: u32) {
    for (var pair = local; 2u * pair < keys + (2u << bits); pair += GROUP_SIZE) {
        let places = places_of(pair, bits, mirrored);
        if places.y < keys {
            let low = lists[into.x + places.x][into.y];
            let high = lists[into.x + places.y][into.y];
            if high < low {
                lists[into.x + places.x][into.y] = high;
                lists[into.x + places.y][into.y] = low;
            }
        }
    }
    storageBarrier();
}

// Makes the comparisons of one distance on the tile in workgroup memory.
fn compare_in_tile(keys: u32, bits: u32, mirrored: bool, local: u32) {
    for (var pair = local; 2u * pair < keys + (2u << bits); pair += GROUP_SIZE) {
        let places = places_of(pair, bits, mirrored);
        if places.y < keys {
            let low = tile[places.x];
            let high = tile[places.y];
            tile[places.x] = min(low, high);
            tile[places.y] = max(low, high);
        }
    }
    workgroupBarrier();
}

// Makes those comparisons of some rounds that stay within a tile, for every tile of the list.
fn order_tiles(first_round: u32, last_round: u32, local: u32) {
    let keys = workgroupUniformLoad(&count);
    for (var first = 0u; first < keys; first += TILE) {
        let there = min(TILE, keys - first);
        for (var k = local; k < there; k += GROUP_SIZE) {
            tile[k] = lists[into.x + first + k][into.y];
        }
        workgroupBarrier();
        for (var round = first_round; round <= last_round; round++) {
            for (var bits = min(round, TILE_BITS); bits > 0u; bits--) {
                compare_in_tile(there, bits - 1u, bits == round, local);
            }
        }
        for (var k = local; k < there; k += GROUP_SIZE) {
            lists[into.x + first + k][into.y] = tile[k];
        }
        workgroupBarrier();
    }
    storageBarrier();
}

// Sorts all keys. All threads of the workgroup must call it.
fn order_keys(local: u32) {
    storageBarrier();
    let keys = workgroupUniformLoad(&count);
    if keys < 2u {
        return;
    }
    let rounds = 32u - countLeadingZeros(keys - 1u);
    order_tiles(1u, min(rounds, TILE_BITS), local);
    for (var round = TILE_BITS + 1u; round <= rounds; round++) {
        for (var bits = round; bits > TILE_BITS; bits--) {
            compare_in_list(keys, bits - 1u, bits == round, local);
        }
        order_tiles(round, round, local);
    }
}
