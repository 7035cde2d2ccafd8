@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<u32>;
@group(0) @binding(6) var<storage, read_write> status: StatusPairs;

// `Status` where the room for entries is given out.
struct StatusPairs {
    void: atomic<u32>,
    pairs_needed: atomic<u32>,
}

// Lists up to this long are put in order on the way, in workgroup memory; longer ones in place, afterwards.
const SHORT: u32 = 48u;

// Key `place` of a thread is at place * WORKGROUP + local.
var<workgroup> keys: array<u32, SHORT * WORKGROUP>;
// The longest list of each slice of the workgroup, and where the slice begins.
var<workgroup> longest: array<atomic<u32>, WORKGROUP / SLICE>;
var<workgroup> offsets: array<u32, WORKGROUP / SLICE>;

// The thread's place in its workgroup.
var<private> own: u32;
// Entries found; the first SHORT are kept.
var<private> kept: u32;
// First word of the list, once it has a place; 0 before.
var<private> into: u32;

// Orders entries by id, then feature.
fn entry_key(entry: u32) -> u32 {
    return (entry & ENTRY_ID_MASK) << 4u | entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK;
}

fn entry_of(key: u32) -> u32 {
    return key >> 4u | (key & ENTRY_FEATURE_MASK) << ENTRY_ID_BITS;
}

// Only put down here: neighbouring threads find at different times, and would wait for each other's sorting.
fn emit(entry: u32) {
    if into != 0u {
        lists[into + kept * SLICE] = entry_key(entry);
    } else if kept < SHORT {
        keys[kept * WORKGROUP + own] = entry_key(entry);
    }
    kept += 1u;
}

// Insertion sort of the keys in workgroup memory, each kept once.
fn order_short() {
    var distinct = 0u;
    for (var place = 0u; place < kept; place++) {
        let key = keys[place * WORKGROUP + own];
        var at = distinct;
        var before = 0u;
        while at > 0u {
            before = keys[(at - 1u) * WORKGROUP + own];
            if before <= key {
                break;
            }
            at -= 1u;
        }
        if (at > 0u) & (before == key) {
            continue;
        }
        for (var k = distinct; k > at; k--) {
            keys[k * WORKGROUP + own] = keys[(k - 1u) * WORKGROUP + own];
        }
        keys[at * WORKGROUP + own] = key;
        distinct += 1u;
    }
    kept = distinct;
}

fn sift_down(first: u32, top: u32, size: u32) {
    var root = top;
    let key = lists[first + root * SLICE];
    loop {
        var child = 2u * root + 1u;
        if child >= size {
            break;
        }
        if child + 1u < size {
            child += u32(lists[first + child * SLICE] < lists[first + (child + 1u) * SLICE]);
        }
        if lists[first + child * SLICE] <= key {
            break;
        }
        lists[first + root * SLICE] = lists[first + child * SLICE];
        root = child;
    }
    lists[first + root * SLICE] = key;
}

// Heap sort in place; then every key once, as an entry. Gives their number.
fn order_long(first: u32, count: u32) -> u32 {
    for (var root = count / 2u; root > 0u; root--) {
        sift_down(first, root - 1u, count);
    }
    for (var size = count - 1u; size > 0u; size--) {
        let greatest = lists[first];
        lists[first] = lists[first + size * SLICE];
        lists[first + size * SLICE] = greatest;
        sift_down(first, 0u, size);
    }
    var distinct = 0u;
    var previous = NONE;
    for (var place = 0u; place < count; place++) {
        let key = lists[first + place * SLICE];
        if key != previous {
            lists[first + distinct * SLICE] = entry_of(key);
            distinct += 1u;
        }
        previous = key;
    }
    return distinct;
}

// Room for a slice as wide as its longest list. A step without room for all is void, and nothing is written past the end.
fn allot(slice: u32, words: u32) -> u32 {
    let offset = atomicAdd(&status.pairs_needed, words);
    lists[step.slices_at + slice] = offset;
    if offset + words > step.pair_capacity {
        atomicOr(&status.void, VOID_PAIRS);
    }
    if offset + words < offset {
        atomicOr(&status.void, VOID_COUNT);
    }
    return select(offset, NONE, (offset + words > step.pair_capacity) | (offset + words < offset));
}

// Writes a list that is in order already.
fn write_short(mover: u32, first: u32) {
    for (var place = 0u; place < kept; place++) {
        lists[first + place * SLICE] = entry_of(keys[place * WORKGROUP + own]);
    }
    lists[mover] = kept;
}

@compute @workgroup_size(64)
fn find_neighbours(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    let slice = local / SLICE;
    own = local;
    if local < WORKGROUP / SLICE {
        atomicStore(&longest[local], 0u);
    }
    workgroupBarrier();
    // Round 0 finds and counts; round 1 finds again what was too much to remember.
    var searches = mover < step.spheres + step.rods;
    if mover < step.slices_at {
        lists[mover] = 0u;
    }
    for (var round = 0u; round < 2u; round++) {
        if searches {
            kept = 0u;
            emit_neighbours(mover);
        }
        if round == 0u {
            if kept <= SHORT {
                order_short();
            }
            atomicMax(&longest[slice], kept);
            workgroupBarrier();
            if (local % SLICE == 0u) & (mover < step.slices_at) {
                offsets[slice] = allot(mover / SLICE, atomicLoad(&longest[slice]) * SLICE);
            }
            workgroupBarrier();
            searches &= offsets[slice] != NONE;
            into = step.entries_at + offsets[slice] + local % SLICE;
            if searches & (kept <= SHORT) {
                write_short(mover, into);
                searches = false;
            }
        } else if searches {
            lists[mover] = order_long(into, kept);
        }
    }
}
