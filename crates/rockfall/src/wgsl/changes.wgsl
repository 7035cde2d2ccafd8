// What its collisions make of a sphere.

struct Change {
    velocity: vec3f,
    position: vec3f,
}

fn add_change(share: vec3f, approach: f32, overlap: f32, displaces: bool, change: ptr<function, Change>) {
    (*change).velocity += share * ((1.0 + step.restitution) * approach);
    if displaces {
        (*change).position += share * overlap;
    }
}

fn add_row(sphere: u32, row: u32, change: ptr<function, Change>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    for (var e = 0u; e < count; e++) {
        let entry = entry_at(slot_of(row, e));
        let id = entry_id(entry);
        if (entry & ENTRY_COLLIDES) == 0u {
            continue;
        }
        if taken_elsewhere(sphere, row, id) {
            continue;
        }
        let pair = ordered(row, id);
        if row == sphere {
            if are_plain(pair.x, pair.y) {
                let k = plain_contact(sphere, id);
                let weight = weigh(vec3u(pair, 0u));
                let share = -k.n * (abs(weight) / k.inverse_mass);
                add_change(share, k.approach, k.overlap, weight < 0.0, change);
                continue;
            }
        }
        if !RODS {
            continue;
        }
        let found = touch(pair.x, pair.y, entry_feature(entry));
        if found.overlap <= 0.0 {
            continue;
        }
        var k = contact_of(pair.x, pair.y, found);
        let weight = weigh(vec3u(pair, entry_feature(entry)));
        let share = share_of(&k, sphere) * (abs(weight) / k.inverse_mass);
        add_change(share, k.approach, k.overlap, weight < 0.0, change);
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

// Whether there are collisions to apply in this attempt at the step.
fn has_changes() -> bool {
    return (atomicLoad(&status.void) == 0u) & (atomicLoad(&status.collided) == 0u) & (atomicLoad(&status.collisions) != 0u);
}

// The state of a sphere after its collisions, where it takes part in some.
fn write_change(i: u32) {
    if !takes_part_in_any(i) {
        return;
    }
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = Motion(old_position.xyz, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let change = changes_of(i);
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
