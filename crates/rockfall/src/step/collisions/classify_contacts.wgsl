// requires physics/surfaces_of_list.wgsl model/counters.wgsl model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/put_head.wgsl
// requires model/step.wgsl physics/chain.wgsl physics/collision.wgsl physics/collision/plain.wgsl physics/contact.wgsl physics/geometry.wgsl
// requires physics/escape.wgsl physics/seams_of_list.wgsl

// Decides which contacts are pressed, and which of them collide (docs/physics section 3.1).

// Overlaps up to this fraction of the smaller radius are rounding errors.
const ROUNDING: f32 = 1e-5;

fn radius_of(id: u32) -> f32 {
    if id < step.spheres {
        return state[position_at(id)].w;
    }
    if RODS {
        return rod_radius(id - step.spheres);
    }
    return 0.0;
}

// The smaller radius of a pair, which the thresholds refer to. `a` is a mover. Boxes and polygons have no radius.
fn pair_radius(a: u32, b: u32) -> f32 {
    let radius = radius_of(a);
    if b < step.spheres + step.rods {
        return min(radius, radius_of(b));
    }
    return radius;
}

// The ENTRY_OVERLAPS and ENTRY_COLLIDES bits of a contact with this overlap, approach velocity, inverse mass and smaller
// radius.
fn bits_of(overlap: f32, approach: f32, inverse_mass: f32, radius: f32, a: u32, b: u32) -> u32 {
    if overlap <= ROUNDING * radius {
        return 0u;
    }
    let is_on = (step.flags & FLAG_COLLISIONS) != 0u;
    let collides = is_on & (inverse_mass > 0.0) & (approach > collision_velocity(radius, a, b));
    return ENTRY_OVERLAPS | select(0u, ENTRY_COLLIDES, collides);
}

// The bits of an entry of a mover. `velocity` is the velocity row of the mover, used only if the mover is a sphere.
fn classify(own: Own, velocity: vec4f, other: LoadedEntry) -> u32 {
    let id = entry_id(other.entry);
    if are_plain(own.id, id) {
        let contact = plain_with(own.id, own.place, velocity, other);
        if contact.inverse_mass <= 0.0 {
            return 0u;
        }
        let radius = select(own.place.w, min(own.place.w, other.place.w), id < step.spheres);
        return bits_of(contact.overlap, contact.approach, contact.inverse_mass, radius, own.id, id);
    }
    if !RODS {
        return 0u;
    }
    let pair = ordered(own.id, id);
    let found = contact_with(own, id, entry_feature(other.entry));
    if found.overlap <= 0.0 {
        return 0u;
    }
    if inverse_mass_at(pair.x, found.a) + inverse_mass_at(pair.y, found.b) <= 0.0 {
        return 0u;
    }
    let contact = approach_at(pair.x, pair.y, found);
    return bits_of(found.overlap, contact.approach, contact.inverse_mass, pair_radius(pair.x, pair.y), pair.x, pair.y);
}

// Selects, from ENTRIES_PER_MASK entries, those that must be classified. Entries without bits whose objects are too far away
// are left out.
fn entries_to_classify(own: Own, first: vec2u, begin: u32, count: u32) -> u32 {
    let bits = ENTRY_OVERLAPS | ENTRY_COLLIDES;
    if !RODS {
        return entries_near(own.place, bits, first, begin, count);
    }
    if own.id < step.spheres {
        let near = entries_near(own.place, bits, first, begin, count);
        return without_distant_rods(own.id, own.place, bits, first, begin, count, near);
    }
    return touching_rod(own.id, own.bar, bits, first, begin, count);
}

// Classifies an entry, which may be hidden, and returns its bits. They are written only if they have changed, which is rare.
fn mark_entry(own: Own, velocity: vec4f, other: LoadedEntry, slot: vec2u, is_hidden: bool) -> u32 {
    let entry = other.entry & ~(ENTRY_OVERLAPS | ENTRY_COLLIDES);
    var bits = classify(own, velocity, other);
    if is_hidden {
        bits = 0u;
    }
    if (bits & ENTRY_COLLIDES) != 0u {
        if is_put_off(own.id, entry_id(other.entry)) {
            bits = ENTRY_OVERLAPS;
        }
    }
    if (entry | bits) != other.entry {
        lists[slot.x][slot.y] = entry | bits;
    }
    return bits;
}

// Marks the entries of a mover, and the mover itself if one of them collides. Returns the number of collisions with objects
// of higher insertion index.
fn mark_entries(mover: u32) -> u32 {
    let first = first_of(mover);
    var found = 0u;
    var any_bits = 0u;
    let count = count_of(mover);
    // The velocity of a rod is not used. The index only has to be valid.
    let sphere = min(mover, step.spheres - 1u);
    let own = own_of(mover);
    let velocity = state[velocity_at(sphere)];
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        var rest = entries_to_classify(own, first, begin, count);
        var hidden = 0u;
        if mover < step.spheres {
            hidden = hidden_entries(mover, own.place, first, begin, count);
        } else if RODS {
            hidden = hidden_edges(own.bar, first, begin, count);
        }
        var now = meet(first, begin, rest);
        while rest != 0u {
            let place = firstTrailingBit(rest);
            let slot = slot_at(first, begin + place);
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            let bits = mark_entry(own, velocity, now, slot, ((hidden >> place) & 1u) != 0u);
            any_bits |= bits;
            if (bits & ENTRY_COLLIDES) != 0u {
                found += select(0u, 1u, ordered(mover, entry_id(now.entry)).x == mover);
            }
            now = ahead;
        }
    }
    mark_head(mover, (any_bits & ENTRY_COLLIDES) != 0u);
    return found;
}

// Sets or clears the mark that an entry of the mover collides.
fn mark_head(mover: u32, collides: bool) {
    let head = head_of(mover);
    let marked = (head & ~LIST_COLLIDES) | select(0u, LIST_COLLIDES, collides);
    if marked != head {
        put_head(mover, marked);
    }
}

fn check_escape(sphere: u32) {
    let own = state[position_at(sphere)];
    let ratio = escape_ratio(own.xyz, own.w, aabbs[sphere]);
    if (ratio > 0.0) & (inverse_mass(sphere) > 0.0) {
        report_escape(ratio, ESCAPED_IN_COLLISIONS);
    }
}

// Adds the collisions of a thread in the workgroup of this number to the counters. Few threads have some.
fn count_collisions(workgroup: u32, found: u32) {
    if found > 0u {
        atomicAdd(&status.counters[workgroup % COUNTER_BLOCKS].collisions, found);
        // Reading the word takes less time than writing it.
        if atomicLoad(&status.collides) == 0u {
            atomicStore(&status.collides, 1u);
        }
    }
}
