// requires model/counters.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl
// requires physics/collision/changes.wgsl physics/collision/impulses.wgsl physics/collision/lone.wgsl
// requires physics/contact.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl

// What its collisions make of an end of a rigid capsule (docs/physics.md sections 3.2 and 3.4).

// The lone collision of a capsule, if it has one: no other contact touches it then.
fn lone_record(rod: u32) -> vec2u {
    let ends = rod_ends(rod);
    var rows = array<u32, 3>(ends.x, ends.y, step.spheres + rod);
    for (var place = 0u; place < 3u; place++) {
        let row = rows[place];
        if has_collisions(row) {
            let count = count_of(row);
            let first = first_of(row);
            for (var begin = 0u; begin < count; begin += LOOK) {
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

// Position, velocity and angular momentum of an end after a kick.
fn kicked(i: u32, capsule: Capsule, is_second: bool, kick: Kick) -> Motion {
    let offset = select(-capsule.centre, 1.0 - capsule.centre, is_second) * capsule.d;
    let momentum = state[momentum_at(i)];
    return Motion(
        state[position_at(i)].xyz,
        state[velocity_at(i)].xyz + kick.velocity + cross(kick.spin, offset),
        momentum.xyz + kick.spin / momentum.w,
    );
}

// An end after a lone collision: the capsule goes back to the time of contact on its circle, is hit, and comes forward again.
fn hit_at_contact(i: u32, half: Half, row: u32, r: u32) -> Motion {
    let k = record_at(r);
    let impulse = impulse_at(r);
    let now = poise_of(half);
    let rod = capsule_rod(half.spheres.x);
    let back = turned(now.x2 - now.x1, now.v2 - now.v1, -impulse.tau);
    let capsule = capsule_of(half.spheres, now);
    let met = capsule_of(half.spheres, Poise(vec3f(0.0), back.d, vec3f(0.0), back.q));
    let is_a = k.a_id == row;
    var at = select(k.b, k.a, is_a);
    if row < step.spheres {
        at = select(0.0, 1.0, half.spheres.y == row);
    }
    let push = select(1.0, -1.0, is_a) * impulse.even * impulse_normal(r);
    let velocity = capsule.inverse_mass * push;
    let spin = met.inverse_inertia * torque_at(met, at, push);
    let forward = turned(back.d, back.q + cross(spin, back.d), impulse.tau);
    let place = (1.0 - capsule.centre) * now.x1 + capsule.centre * now.x2 + impulse.tau * velocity;
    let share = select(-capsule.centre, 1.0 - capsule.centre, half.spheres.y == i);
    let momentum = state[momentum_at(i)];
    return Motion(place + share * forward.d, capsule.velocity + velocity + share * forward.q, momentum.xyz + spin / momentum.w);
}

// The state of an end after the capsule's collisions.
fn write_capsule_end(i: u32, rod: u32) {
    let ends = rod_ends(rod);
    let half = half_of(i, 0.0);
    let lone = lone_record(rod);
    if lone.x != NONE {
        write_motion(i, hit_at_contact(i, half, lone.x, lone.y));
        return;
    }
    let capsule = capsule_of(ends, poise_of(half));
    write_motion(i, kicked(i, capsule, ends.y == i, kick_of(capsule, rod, SWEEPS)));
}
