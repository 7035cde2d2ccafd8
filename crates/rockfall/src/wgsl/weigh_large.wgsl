// What the collisions of a large sphere weigh, where there are no rods. A thread weighs one of them; the contacts of the sphere, which all
// of them are coupled with, are worked out once for the team, so many at a time.

// Normals of the contacts, and the roots of their G_kk; 0 where there is none. Their entries.
var<workgroup> tile: array<vec4f, WORKGROUP>;
var<workgroup> tile_entries: array<u32, WORKGROUP>;

fn put_tile(sphere: u32, own: vec4f, velocity: vec4f, slot: vec2u, is_there: bool, local: u32) {
    var row = vec4f(0.0);
    if is_there {
        let entry = entry_at(slot);
        tile_entries[local] = entry;
        if (entry & ENTRY_OVERLAPS) != 0u {
            let contact = plain_with(sphere, own, velocity, met(entry, true));
            row = vec4f(contact.n, select(0.0, sqrt(contact.inverse_mass), contact.overlap > 0.0));
        }
    }
    tile[local] = row;
}

// Adds the contacts of the tile, but for that with `other`, that are coupled with the one of normal `n` and inverse mass G_kk.
fn add_tile(inverse_mass: f32, other: u32, k: Plain, sums: ptr<function, RowSums>) {
    for (var c = 0u; c < WORKGROUP; c++) {
        let l = tile[c];
        if l.w > 0.0 {
            let entry = tile_entries[c];
            if entry_id(entry) != other {
                add_term(inverse_mass * abs(dot(k.n, l.xyz)) / (sqrt(k.inverse_mass) * l.w), entry, sums);
            }
        }
    }
}

// Weighs a collision of each thread that has one, as `plain_row_sum` does: in the order of both lists, that of the first before that
// of the other. All threads of the workgroup must come here.
fn weigh_one_each(sphere: u32, slot: vec2u, has_one: bool, local: u32) {
    let own = state[position_at(sphere)];
    let velocity = state[velocity_at(sphere)];
    let count = count_of(sphere);
    let first = first_of(sphere);
    let other = select(NONE, entry_id(entry_at(slot)), has_one);
    let pair = ordered(sphere, select(sphere, other, has_one));
    let is_second = has_one & (pair.x == other);
    var k = Plain(vec3f(0.0), 0.0, 0.0, 0.0);
    var sums = RowSums(1.0, 1.0);
    if has_one {
        k = plain_contact(pair.x, pair.y);
    }
    if is_second {
        add_coupled_plain(other, sphere, k.n, k.inverse_mass, &sums);
    }
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        put_tile(sphere, own, velocity, slot_at(first, begin + local), begin + local < count, local);
        workgroupBarrier();
        if has_one & (velocity.w > 0.0) {
            add_tile(velocity.w, other, k, &sums);
        }
        workgroupBarrier();
    }
    if has_one & !is_second & (other < step.spheres) {
        add_coupled_plain(other, sphere, k.n, k.inverse_mass, &sums);
    }
    if has_one {
        put_sum(sphere, slot, signed_sum(sums));
    }
}

// Puts down the collisions among every so many-th entry from one on, as many as there is room for; gives the entry to go on from.
fn put_down_share(sphere: u32, begin: u32) -> u32 {
    let count = count_of(sphere);
    let first = first_of(sphere);
    for (var e = begin; e < count; e += WORKGROUP) {
        if (entry_at(slot_at(first, e)) & ENTRY_COLLIDES) != 0u {
            if !put_down_one(sphere, e) {
                return e;
            }
        }
    }
    return count;
}

fn weigh_together(sphere: u32, local: u32) {
    let begin = first_of(sphere);
    var next = local;
    loop {
        next = put_down_share(sphere, next);
        let queued = counted_up(local, QUEUE);
        if queued == 0u {
            break;
        }
        for (var first = 0u; first < queued; first += WORKGROUP) {
            let e = places[min(first + local, queued - 1u)].y;
            weigh_one_each(sphere, slot_at(begin, e), first + local < queued, local);
        }
        workgroupBarrier();
    }
}
