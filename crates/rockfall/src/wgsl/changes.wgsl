// What its collisions make of a sphere.

struct Change {
    velocity: vec3f,
    position: vec3f,
}

// What a collision gives a sphere: its share of the unit impulse, so many times into the velocity, so many times into the position.
struct Part {
    share: vec3f,
    velocity: f32,
    position: f32,
}

// Told to be one operation: whoever adds up, the same bits come of it.
fn add_part(part: Part, change: ptr<function, Change>) {
    (*change).velocity = fma(part.share, vec3f(part.velocity), (*change).velocity);
    (*change).position = fma(part.share, vec3f(part.position), (*change).position);
}

fn no_part() -> Part {
    return Part(vec3f(0.0), 0.0, 0.0);
}

fn part_of(share: vec3f, approach: f32, overlap: f32, row_sum: f32) -> Part {
    return Part(share, (1.0 + step.restitution) * approach, select(0.0, overlap, row_sum < 0.0));
}

// What the colliding entry in this slot, of one of a sphere's rows, gives it.
fn part_of_entry(sphere: u32, row: u32, slot: vec2u) -> Part {
    let entry = entry_at(slot);
    let id = entry_id(entry);
    if taken_elsewhere(sphere, row, id) {
        return no_part();
    }
    let pair = ordered(row, id);
    if row == sphere {
        if are_plain(pair.x, pair.y) {
            let k = plain_contact(sphere, id);
            let row_sum = row_sum_of(pair, slot);
            return part_of(-k.n * (1.0 / abs(row_sum) / k.inverse_mass), k.approach, k.overlap, row_sum);
        }
    }
    if !RODS {
        return no_part();
    }
    let found = touch(pair.x, pair.y, entry_feature(entry));
    if found.overlap <= 0.0 {
        return no_part();
    }
    var k = contact_of(pair.x, pair.y, found);
    let row_sum = row_sum_of(pair, slot);
    return part_of(share_of(&k, sphere) * (1.0 / abs(row_sum) / k.inverse_mass), k.approach, k.overlap, row_sum);
}

fn add_row(sphere: u32, row: u32, change: ptr<function, Change>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += LOOK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            add_part(part_of_entry(sphere, row, slot_at(first, begin + firstTrailingBit(rest))), change);
        }
    }
}

fn changes_of(sphere: u32) -> Change {
    var change = Change(vec3f(0.0), vec3f(0.0));
    let rods = rods_of(sphere);
    for (var r = 0u; r < 1u + 2u * rods.y; r++) {
        let row = row_of(sphere, rods, r);
        if row != NONE {
            add_row(sphere, row, &change);
        }
    }
    return change;
}

// The state of a sphere after its collisions.
fn write_change(i: u32) {
    var change = Change(vec3f(0.0), vec3f(0.0));
    if inverse_mass(i) > 0.0 {
        change = changes_of(i);
    }
    write_changed(i, change);
}

fn write_changed(i: u32, change: Change) {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = Motion(old_position.xyz, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        after.velocity += old_velocity.w * change.velocity;
        after.position += old_velocity.w * change.position;
        if !is_finite(after) {
            after = stopped(old_position.xyz, 0u, i);
        }
    }
    let position = vec4f(after.position, old_position.w);
    let velocity = vec4f(after.velocity, old_velocity.w);
    ask_for_lists(i, position, velocity);
    put_next(0u, i, position);
    put_next(1u, i, velocity);
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
}
