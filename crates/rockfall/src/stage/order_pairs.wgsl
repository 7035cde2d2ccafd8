@group(0) @binding(2) var<storage, read_write> lists: array<u32>;
@group(0) @binding(3) var<storage, read> status: Status;

// Lists up to this long are sorted in the thread's own memory.
const SHORT: u32 = 32u;

// Orders entries by id, then feature.
fn entry_key(entry: u32) -> u32 {
    return (entry & ENTRY_ID_MASK) << 4u | entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK;
}

fn entry_of(key: u32) -> u32 {
    return key >> 4u | (key & ENTRY_FEATURE_MASK) << ENTRY_ID_BITS;
}

// Insertion sort that drops what is there already; the number that is left.
fn order_short(first: u32, count: u32) -> u32 {
    var keys: array<u32, SHORT>;
    var kept = 0u;
    for (var place = 0u; place < count; place++) {
        let key = entry_key(lists[first + place * SLICE]);
        var at = kept;
        while at > 0u {
            if keys[at - 1u] <= key {
                break;
            }
            keys[at] = keys[at - 1u];
            at -= 1u;
        }
        if at > 0u {
            if keys[at - 1u] == key {
                // What was moved for it moves back.
                for (var k = at; k < kept; k++) {
                    keys[k] = keys[k + 1u];
                }
                continue;
            }
        }
        keys[at] = key;
        kept += 1u;
    }
    for (var place = 0u; place < kept; place++) {
        lists[first + place * SLICE] = entry_of(keys[place]);
    }
    return kept;
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

// Heap sort in place, then the same.
fn order_long(first: u32, count: u32) -> u32 {
    for (var place = 0u; place < count; place++) {
        lists[first + place * SLICE] = entry_key(lists[first + place * SLICE]);
    }
    for (var root = count / 2u; root > 0u; root--) {
        sift_down(first, root - 1u, count);
    }
    for (var size = count - 1u; size > 0u; size--) {
        let greatest = lists[first];
        lists[first] = lists[first + size * SLICE];
        lists[first + size * SLICE] = greatest;
        sift_down(first, 0u, size);
    }
    var kept = 0u;
    var previous = NONE;
    for (var place = 0u; place < count; place++) {
        let key = lists[first + place * SLICE];
        let is_new = key != previous;
        previous = key;
        if is_new {
            lists[first + kept * SLICE] = entry_of(key);
            kept += 1u;
        }
    }
    return kept;
}

@compute @workgroup_size(64)
fn order_pairs(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    if (status.void != 0u) | (mover >= step.spheres + step.rods) {
        return;
    }
    let count = lists[mover];
    let first = step.entries_at + lists[step.slices_at + mover / SLICE] + mover % SLICE;
    var kept = count;
    if count > SHORT {
        kept = order_long(first, count);
    } else if count > 1u {
        kept = order_short(first, count);
    }
    if kept != count {
        lists[mover] = kept;
    }
}
