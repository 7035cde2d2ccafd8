// requires model/order.wgsl model/step.wgsl

// In-place heap sort of the keys of a pair list. `first` is the slot of its first entry.

// Moves the key at `top` down to its place in the heap of `size` keys, whose root is the greatest key.
fn sift_down(first: vec2u, top: u32, size: u32) {
    var root = top;
    let key = lists[first.x + root][first.y];
    loop {
        var child = 2u * root + 1u;
        if child >= size {
            break;
        }
        if child + 1u < size {
            child += u32(lists[first.x + child][first.y] < lists[first.x + child + 1u][first.y]);
        }
        if lists[first.x + child][first.y] <= key {
            break;
        }
        lists[first.x + root][first.y] = lists[first.x + child][first.y];
        root = child;
    }
    lists[first.x + root][first.y] = key;
}

// Sorts the keys, drops duplicates, and replaces the keys by entries. Returns the number of entries.
fn heap_sort_list(first: vec2u, count: u32) -> u32 {
    if count == 0u {
        return 0u;
    }
    for (var root = count / 2u; root > 0u; root--) {
        sift_down(first, root - 1u, count);
    }
    for (var size = count - 1u; size > 0u; size--) {
        let greatest = lists[first.x][first.y];
        lists[first.x][first.y] = lists[first.x + size][first.y];
        lists[first.x + size][first.y] = greatest;
        sift_down(first, 0u, size);
    }
    var distinct = 0u;
    var previous = NONE;
    for (var place = 0u; place < count; place++) {
        let key = lists[first.x + place][first.y];
        if key != previous {
            lists[first.x + distinct][first.y] = entry_of(key);
            distinct += 1u;
        }
        previous = key;
    }
    return distinct;
}
