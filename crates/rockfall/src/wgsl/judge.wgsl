// Which pairs overlap, and which of them collide.

// Overlaps up to this times the smaller radius are rounding.
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

// The radius that thresholds refer to, of a pair, the first added first.
fn pair_radius(a: u32, b: u32) -> f32 {
    let radius = radius_of(a);
    if b < step.spheres + step.rods {
        return min(radius, radius_of(b));
    }
    return radius;
}

// The OVERLAPS and COLLIDES bits of what overlaps so deep, closes so fast and weighs so much.
fn bits_of(overlap: f32, approach: f32, inverse_mass: f32, radius: f32) -> u32 {
    if overlap <= ROUNDING * radius {
        return 0u;
    }
    let collides = (inverse_mass > 0.0) & (approach > step.activation_threshold * radius);
    return ENTRY_OVERLAPS | select(0u, ENTRY_COLLIDES, collides);
}

// The bits of a pair, the first added first.
fn judge(a: u32, b: u32, feature: u32) -> u32 {
    let radius = pair_radius(a, b);
    if are_plain(a, b) {
        let contact = plain_contact(a, b);
        if contact.inverse_mass <= 0.0 {
            return 0u;
        }
        return bits_of(contact.overlap, contact.approach, contact.inverse_mass, radius);
    }
    let found = touch(a, b, feature);
    if found.overlap <= 0.0 {
        return 0u;
    }
    let contact = contact_of(a, b, found);
    return bits_of(found.overlap, contact.approach, contact.inverse_mass, radius);
}

// Which of four entries are judged: all but spheres without bits that are too far from this one. The slack leaves those near the
// edge to the test that counts.
fn which_to_judge(mover: u32, entries: vec4u, e: u32, count: u32) -> u32 {
    let marked = (entries & vec4u(ENTRY_OVERLAPS | ENTRY_COLLIDES)) != vec4u(0u);
    let others = (entries & vec4u(ENTRY_ID_MASK)) >= vec4u(step.spheres);
    if mover >= step.spheres {
        return which(vec4<bool>(true), e, count);
    }
    return which(marked | others | close(state[position_at(mover)], four_spheres(entries, mover), 1.00001), e, count);
}

// Marks the entries of a mover, and the mover where one of them collides, and gives the number of collisions with objects of higher id.
fn mark_entries(mover: u32) -> u32 {
    let first = slot_of(mover, 0u);
    var collisions = 0u;
    var any_bits = 0u;
    let count = count_of(mover);
    for (var e = 0u; e < count; e += 4u) {
        let entries = four_entries(first, e, count);
        for (var rest = which_to_judge(mover, entries, e, count); rest != 0u; rest &= rest - 1u) {
            let at = firstTrailingBit(rest);
            let old = one_of(entries, at);
            let entry = old & ~(ENTRY_OVERLAPS | ENTRY_COLLIDES);
            let pair = ordered(mover, entry_id(entry));
            let bits = judge(pair.x, pair.y, entry_feature(entry));
            // Few change from step to step.
            if (entry | bits) != old {
                lists[step.entries_at + first + (e + at) * SLICE] = entry | bits;
            }
            any_bits |= bits;
            collisions += select(0u, 1u, ((bits & ENTRY_COLLIDES) != 0u) & (pair.x == mover));
        }
    }
    let unmarked = lists[mover] & ~LIST_COLLIDES;
    let marked = unmarked | select(0u, LIST_COLLIDES, (any_bits & ENTRY_COLLIDES) != 0u);
    if marked != lists[mover] {
        lists[mover] = marked;
    }
    return collisions;
}

fn check_escape(sphere: u32) {
    let own = state[position_at(sphere)];
    let ratio = escape_ratio(own.xyz, own.w, aabbs[sphere]);
    if (ratio > 0.0) & (inverse_mass(sphere) > 0.0) {
        tell_escape(ratio);
    }
}

// Adds a workgroup's collisions to the status; all its threads must come here.
fn tell_collisions(local: u32, collisions: u32) {
    if local == 0u {
        atomicStore(&group_count, 0u);
    }
    workgroupBarrier();
    if collisions > 0u {
        atomicAdd(&group_count, collisions);
    }
    workgroupBarrier();
    if local == 0u {
        let sum = atomicLoad(&group_count);
        if sum > 0u {
            atomicAdd(&status.collisions, sum);
        }
    }
}
