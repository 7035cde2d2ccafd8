// requires model/entries.wgsl model/lists.wgsl model/collision_state.wgsl model/order.wgsl model/step.wgsl physics/collision.wgsl
// requires physics/contact.wgsl physics/geometry.wgsl step/collisions/has_changes.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl step/collisions/report_clusters.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read_write> collisions: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

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

fn list_entry(mover: u32, slot: vec2u) {
    let entry = entry_at(slot);
    let id = entry_id(entry);
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

fn list_all(mover: u32) {
    let count = count_of(mover);
    let first = first_of(mover);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let slot = slot_at(first, begin + firstTrailingBit(rest));
            if is_own(mover, entry_id(entry_at(slot))) {
                list_entry(mover, slot);
            }
        }
    }
}

// Workgroups are large because most movers have nothing to do: the time of this stage depends on the number of workgroups.
@compute @workgroup_size(256)
fn list_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = wide_thread(group, groups, local);
    if mover < step.spheres + step.rods {
        if has_collisions(mover) {
            if has_changes() {
                list_all(mover);
            }
        }
    }
}
