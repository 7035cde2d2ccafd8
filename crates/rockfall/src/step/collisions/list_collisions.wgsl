// requires model/entries.wgsl model/lists.wgsl model/order.wgsl model/step.wgsl physics/collision.wgsl
// requires physics/chain.wgsl physics/contact.wgsl physics/round_pair.wgsl step/collisions/records.wgsl step/collisions/report_clusters.wgsl

// Creates a record for every collision, and stores its number with the list entries of both sides.
//
// Meanwhile the thread of the other side may change the ENTRY_OVERLAPS and ENTRY_COLLIDES bits of its entries and the LIST_COLLIDES bit of
// its count. The functions below use the other bits of these words only, which do not change.

// Finds a mover in the list of another mover, which is sorted, and returns the slot. Its row is NONE if the mover is not
// there. The search can ignore features: only contacts of a rod with a box have one, and they are in the rod's list only.
fn slot_in(row: u32, mover: u32) -> vec2u {
    let key = entry_key(mover, 0u);
    let first = first_of(row);
    var low = 0u;
    var high = count_of(row);
    while low < high {
        let middle = (low + high) / 2u;
        let entry = entry_at(slot_at(first, middle));
        if entry_id(entry) == mover {
            return slot_at(first, middle);
        }
        if entry_key(entry_id(entry), 0u) < key {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return vec2u(NONE);
}

// Whether the mover creates the record of its collision with this object. Of two movers, the one with the shorter list
// does, because a mover with a long list may have many collisions.
fn is_own(mover: u32, id: u32) -> bool {
    if id >= step.spheres + step.rods {
        return true;
    }
    let own = count_of(mover);
    let other = count_of(id);
    return (own < other) | ((own == other) & (insertion_index(mover) < insertion_index(id)));
}

// Stores the number of a record with the entries of both sides.
fn put_number(mover: u32, slot: vec2u, number: u32) {
    collision_indices[row_of_entries(slot)][slot.y] = number;
    let id = entry_id(entry_at(slot));
    if id < step.spheres + step.rods {
        let other = slot_in(id, mover);
        if other.x != NONE {
            collision_indices[row_of_entries(other)][other.y] = number;
        }
    }
}

fn put_record(number: u32, pair: vec2u, feature: u32, found: Touch, closing: ApproachSpeed) {
    let at = bitcast<vec2u>(vec2f(found.a, found.b));
    collisions[row_at(number, 0u)] = bitcast<vec4u>(vec4f(found.n, closing.approach));
    collisions[row_at(number, 1u)] = vec4u(pair.x, pair.y | (feature << ENTRY_ID_BITS), at.x, at.y);
    if RODS {
        for (var row = 4u; row < ROWS; row++) {
            collisions[row_at(number, row)] = vec4u(0u);
        }
    }
}

// Creates the record of an entry that collides, unless the other side does.
fn list_entry(mover: u32, slot: vec2u) {
    let entry = entry_at(slot);
    let id = entry_id(entry);
    if !is_own(mover, id) {
        return;
    }
    let number = atomicAdd(&status.listed, 1u);
    if number >= step.collision_room {
        reject_for_collisions();
        return;
    }
    let pair = ordered(mover, id);
    let found = touch(pair.x, pair.y, entry_feature(entry));
    put_record(number, pair, entry_feature(entry), found, approach_at(pair.x, pair.y, found));
    put_number(mover, slot, number);
}

// Creates the records of the collisions of a mover.
fn list_all(mover: u32) {
    let count = count_of(mover);
    let first = first_of(mover);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            list_entry(mover, slot_at(first, begin + firstTrailingBit(rest)));
        }
    }
}
