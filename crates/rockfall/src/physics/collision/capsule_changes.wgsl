// requires model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/collision/changes.wgsl
// requires physics/collision/impulses.wgsl physics/collision/lone.wgsl physics/contact.wgsl physics/motion.wgsl
// requires step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl

// The state of an end of a rigid capsule after the collisions of the capsule (docs/physics sections 3.3, 3.6 and 3.7).

// Returns the row and the record of the lone collision of a capsule, or NONE. It is enough to look at the first collision,
// because no other pressed contact touches a capsule that has a lone collision.
fn lone_record(rod: u32) -> vec2u {
    let ends = rod_ends(rod);
    var rows = array<u32, 3>(ends.x, ends.y, step.spheres + rod);
    for (var place = 0u; place < 3u; place++) {
        let row = rows[place];
        if has_collisions(row) {
            let count = count_of(row);
            let first = first_of(row);
            for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
                let found = entries_with(ENTRY_COLLIDES, first, begin, count);
                if found != 0u {
                    let r = record_of(slot_at(first, begin + firstTrailingBit(found)));
                    return select(vec2u(NONE), vec2u(row, r), impulse_at(r).tau >= 0.0);
                }
            }
        }
    }
    return vec2u(NONE);
}

// The state of an end after a change of the capsule's velocity and spin.
fn kicked(i: u32, capsule: Capsule, is_second: bool, kick: CapsuleChange) -> Motion {
    let offset = select(-capsule.centre, 1.0 - capsule.centre, is_second) * capsule.d;
    let momentum = state[momentum_at(i)];
    return Motion(
        state[position_at(i)].xyz,
        low_row(i),
        state[velocity_at(i)].xyz + kick.velocity + cross(kick.spin, offset),
        momentum.xyz + kick.spin / momentum.w,
    );
}

// The state of an end after a lone collision. The capsule is moved back along its circle to the time of contact, gets the
// impulse there, and is moved forward again.
fn hit_at_contact(i: u32, half: ContactSide, row: u32, r: u32) -> Motion {
    let k = record_at(r);
    let impulse = impulse_at(r);
    let now = side_motion(half);
    let rod = capsule_rod(half.spheres.x);
    let back = turned(now.x2 - now.x1, now.v2 - now.v1, -impulse.tau);
    let capsule = capsule_of(half.spheres, now);
    let capsule_then = capsule_of(half.spheres, SideMotion(vec3f(0.0), back.d, vec3f(0.0), back.q));
    let is_a = k.a_id == row;
    var at = select(k.b, k.a, is_a);
    if row < step.spheres {
        at = select(0.0, 1.0, half.spheres.y == row);
    }
    let push = select(1.0, -1.0, is_a) * impulse.even * impulse_normal(r);
    let velocity = capsule.inverse_mass * push;
    let spin = capsule_then.inverse_inertia * torque_at(capsule_then, at, push);
    let forward = turned(back.d, back.q + cross(spin, back.d), impulse.tau);
    let share = select(-capsule.centre, 1.0 - capsule.centre, half.spheres.y == i);
    let momentum = state[momentum_at(i)];
    let pushed = capsule.velocity + velocity + share * forward.q;
    let before = Motion(state[position_at(i)].xyz, low_row(i), pushed, momentum.xyz + spin / momentum.w);
    return displaced(before, impulse.tau * velocity + share * (forward.d - capsule.d));
}

// Writes the state of an end after the collisions of its capsule.
fn write_capsule_end(i: u32, rod: u32) {
    let ends = rod_ends(rod);
    let half = contact_side(i, 0.0);
    let lone = lone_record(rod);
    if lone.x != NONE {
        write_motion(i, hit_at_contact(i, half, lone.x, lone.y));
        return;
    }
    let capsule = capsule_of(ends, side_motion(half));
    write_motion(i, kicked(i, capsule, ends.y == i, capsule_change(capsule, rod, SWEEPS)));
}
