// requires model/step.wgsl

// From the order of memory to the order of addition and back.

// Index of an object in order of addition. Whatever must not depend on the order of memory goes by it.
fn insertion_index(id: u32) -> u32 {
    if (step.insertion_indices_at == 0u) | (id >= step.spheres) {
        return id;
    }
    return topology[step.insertion_indices_at + id];
}

// Two objects, the one that was added first before the other.
fn ordered(a: u32, b: u32) -> vec2u {
    return select(vec2u(b, a), vec2u(a, b), insertion_index(a) < insertion_index(b));
}

// The memory slot of a sphere, and every other object's id, by its index in order of addition.
fn id_of(user: u32) -> u32 {
    if (step.slots_at == 0u) | (user >= step.spheres) {
        return user;
    }
    return topology[step.slots_at + user];
}

// Orders entries by index in order of addition, then feature: not by id, for the order of memory must not show.
fn entry_key(id: u32, feature: u32) -> u32 {
    return insertion_index(id) << FEATURE_BITS | feature;
}

fn entry_of(key: u32) -> u32 {
    return id_of(key >> FEATURE_BITS) | (key & FEATURE_MASK) << ENTRY_ID_BITS;
}
