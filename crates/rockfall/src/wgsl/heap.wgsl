// Putting a list in order where it stands.

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
    if count == 0u {
        return 0u;
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
