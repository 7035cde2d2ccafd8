// requires model/step.wgsl

// Conversion between memory slots and insertion indices.

// Insertion index of an object. Results that must not depend on the order of memory use it.
fn insertion_index(id: u32) -> u32 {
    if (step.insertion_indices_at == 0u) | (id >= step.spheres) {
        return id;
    }
    return topology[step.insertion_indices_at + id];
}

// Two objects in insertion order.
fn ordered(a: u32, b: u32) -> vec2u {
    return select(vec2u(b, a), vec2u(a, b), insertion_index(a) < insertion_index(b));
}

// Id of the object with an insertion index. For a sphere, it is the memory slot.
fn id_of(index: u32) -> u32 {
    if (step.slots_at == 0u) | (index >= step.spheres) {
        return index;
    }
    return topology[step.slots_at + index];
}

// Sort key of an entry: insertion index, then feature. It does not use the id, because results must not depend on the order of
// memory.
fn entry_key(id: u32, feature: u32) -> u32 {
    return (insertion_index(id) << FEATURE_BITS) | feature;
}

fn entry_of(key: u32) -> u32 {
    return id_of(key >> FEATURE_BITS) | ((key & FEATURE_MASK) << ENTRY_ID_BITS);
}
