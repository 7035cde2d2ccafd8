// How much each of many collisions of one body weighs (physics.md section 3). Both sides of a contact work out its weight, by
// the same sums in the same order.

// Row sum up to which nothing else presses, so that the overlap may be removed.
const ALONE: f32 = 1.001;

// Sums of |G_kl| / sqrt(G_kk G_ll).
struct RowSums {
    colliding: f32,
    overlapping: f32,
}

// Whether a sphere that moves stands in an earlier slot of k and takes part in l: then l is counted already.
fn counted(k: ptr<function, Contact>, slot: u32, l: ptr<function, Contact>) -> bool {
    for (var s = 0u; s < slot; s++) {
        if ((*k).inverse_masses[s] > 0.0) & ((*k).spheres[s] != NONE) {
            if takes_part(l, (*k).spheres[s]) {
                return true;
            }
        }
    }
    return false;
}

// Adds the contacts in one row of the sphere in a slot of k. `name` is k's ids and feature.
fn add_coupled(k: ptr<function, Contact>, name: vec3u, slot: u32, row: u32, sums: ptr<function, RowSums>) {
    let count = count_of(row);
    let first = slot_of(row, 0u);
    for (var begin = 0u; begin < count; begin += LOOK) {
        for (var rest = entries_with(ENTRY_OVERLAPS, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let entry = entry_at(first + (begin + firstTrailingBit(rest)) * SLICE);
            add_coupled_entry(k, name, slot, row, entry, sums);
        }
    }
}

fn add_coupled_entry(k: ptr<function, Contact>, name: vec3u, slot: u32, row: u32, entry: u32, sums: ptr<function, RowSums>) {
    let id = entry_id(entry);
    if taken_elsewhere((*k).spheres[slot], row, id) {
        return;
    }
    let other = vec3u(ordered(row, id), entry_feature(entry));
    let found = touch(other.x, other.y, other.z);
    var l = contact_of(other.x, other.y, found);
    if (l.inverse_mass <= 0.0) | (found.overlap <= 0.0) {
        return;
    }
    if counted(k, slot, &l) {
        return;
    }
    var term = 1.0;
    if any(other != name) {
        term = abs(coupling(k, &l)) / (sqrt((*k).inverse_mass) * sqrt(l.inverse_mass));
    }
    add_term(term, entry, sums);
}

fn add_term(term: f32, entry: u32, sums: ptr<function, RowSums>) {
    (*sums).overlapping += term;
    if (entry & ENTRY_COLLIDES) != 0u {
        (*sums).colliding += term;
    }
}

// Adds the contacts of a plain sphere, `other` left out, coupled with a contact of normal `n` there and inverse mass G_kk.
// False where one of them is not plain.
fn add_coupled_plain(sphere: u32, other: u32, n: vec3f, inverse_mass: f32, sums: ptr<function, RowSums>) -> bool {
    let velocity = state[velocity_at(sphere)];
    if velocity.w <= 0.0 {
        return true;
    }
    let own = state[position_at(sphere)];
    let count = count_of(sphere);
    let first = slot_of(sphere, 0u);
    for (var begin = 0u; begin < count; begin += LOOK) {
        var rest = entries_with(ENTRY_OVERLAPS, first, begin, count);
        var now = meet(first, begin, rest);
        while rest != 0u {
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            let id = entry_id(now.entry);
            if !are_plain(sphere, id) {
                return false;
            }
            let l = plain_with(sphere, own, velocity, now);
            if (id != other) & (l.overlap > 0.0) {
                add_term(velocity.w * abs(dot(n, l.n)) / (sqrt(inverse_mass) * sqrt(l.inverse_mass)), now.entry, sums);
            }
            now = ahead;
        }
    }
    return true;
}

// The weight of a plain contact among plain ones; 0 where one is not plain.
fn weigh_plain(a: u32, b: u32) -> f32 {
    let k = plain_contact(a, b);
    var sums = RowSums(1.0, 1.0);
    if !add_coupled_plain(a, b, k.n, k.inverse_mass, &sums) {
        return 0.0;
    }
    if b < step.spheres {
        if !add_coupled_plain(b, a, k.n, k.inverse_mass, &sums) {
            return 0.0;
        }
    }
    return weight_from(sums);
}

fn weight_from(sums: RowSums) -> f32 {
    let weight = 1.0 / max(sums.colliding, 1.0);
    return select(weight, -weight, sums.overlapping <= ALONE);
}

// s_k, negative where the overlap is to be removed.
fn weigh(name: vec3u) -> f32 {
    if are_plain(name.x, name.y) {
        let weight = weigh_plain(name.x, name.y);
        if weight != 0.0 {
            return weight;
        }
    }
    if !RODS {
        return 0.0;
    }
    var k = contact_of(name.x, name.y, touch(name.x, name.y, name.z));
    var sums = RowSums(0.0, 0.0);
    for (var slot = 0u; slot < 4u; slot++) {
        let sphere = k.spheres[slot];
        // What cannot move couples nothing.
        if (sphere == NONE) | (k.inverse_masses[slot] <= 0.0) {
            continue;
        }
        let rods = rods_of(sphere);
        for (var r = 0u; r < 1u + 2u * rods.y; r++) {
            let row = row_of(sphere, rods, r);
            if row != NONE {
                add_coupled(&k, name, slot, row, &sums);
            }
        }
    }
    return weight_from(sums);
}
