// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/collision.wgsl
// requires physics/contact.wgsl physics/round_pair.wgsl physics/pairs.wgsl physics/touch.wgsl step/collisions/record_of.wgsl
// requires step/collisions/records.wgsl

// Friction impulses of pressed contacts (docs/physics section 3.9). The impulse of a contact counts every body as if it were
// split evenly among the pressed contacts that touch it. Joining the parts again never adds energy.

// The friction impulse of a contact.
struct FrictionImpulse {
    // Impulse on A. B gets the opposite.
    impulse: vec3f,
    n: vec3f,
    arms: vec2f,
    // Parameters of the contact on A and B.
    at: vec2f,
    a_id: u32,
}

// Number of pressed contacts in the list of a mover.
fn pressed_in(row: u32) -> u32 {
    let count = count_of(row);
    let first = first_of(row);
    var found = 0u;
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        found += countOneBits(entries_with(ENTRY_OVERLAPS, first, begin, count));
    }
    return found;
}

// Number of pressed contacts that touch a sphere or a rod that ends in it.
fn pressed_on(sphere: u32) -> f32 {
    var found = pressed_in(sphere);
    if RODS {
        let rods = rods_of(sphere);
        for (var r = 0u; r < rods.y; r++) {
            found += pressed_in(step.spheres + index_of(topology[rods.x + r]));
        }
    }
    return f32(found);
}

// Number of pressed contacts that touch a rigid capsule: its ends or its rod.
fn pressed_on_capsule(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    return f32(pressed_in(ends.x) + pressed_in(ends.y) + pressed_in(step.spheres + rod));
}

fn friction_side(half: ContactSide) -> Side {
    if half.kind == STATIC {
        return static_side();
    }
    if half.id < step.spheres {
        return sphere_side(state[position_at(half.id)], state[velocity_at(half.id)], state[momentum_at(half.id)]);
    }
    return rod_side(half.id - step.spheres, half.at);
}

// Impulse and torque on a capsule.
struct CapsuleLoad {
    push: vec3f,
    // Torque about the centre of mass: the part across the axis, and the part along it.
    turning: vec3f,
    rolling: vec3f,
}

// The load on a capsule by the impulse `push` and the torque `own_torque` at parameter `at` of its axis.
fn capsule_load(capsule: Capsule, at: f32, push: vec3f, own_torque: vec3f) -> CapsuleLoad {
    let torque = torque_at(capsule, at, push) + own_torque;
    let turning = across_axis(torque, capsule.d);
    return CapsuleLoad(push, turning, torque - turning);
}

// 1 / (I1 + I2) of a capsule's ends.
fn inverse_roll(ends: vec2u) -> f32 {
    return 1.0 / (1.0 / state[momentum_at(ends.x)].w + 1.0 / state[momentum_at(ends.y)].w);
}

// Tangential inverse mass through one sphere, which is split among the pressed contacts that touch it. `part` is the share of
// the impulse that the sphere gets.
fn slip_inverse_mass_of_sphere(sphere: u32, part: f32, arm: f32) -> f32 {
    let w = inverse_mass(sphere);
    if (w <= 0.0) | (part == 0.0) {
        return 0.0;
    }
    return pressed_on(sphere) * part * part * (w + arm * arm * state[momentum_at(sphere)].w);
}

// Tangential inverse mass through one side. The unit impulse on A is p, the one on B is -p. The torque per arm is the same on
// both.
fn slip_inverse_mass_of(half: ContactSide, n: vec3f, p: vec3f, arm: f32, is_a: bool) -> f32 {
    if half.kind == STATIC {
        return 0.0;
    }
    if !RODS | (half.kind == SPHERE) {
        return slip_inverse_mass_of_sphere(half.spheres.x, 1.0, arm);
    }
    if half.kind == ROD {
        let one = slip_inverse_mass_of_sphere(half.spheres.x, 1.0 - half.at, arm);
        return one + slip_inverse_mass_of_sphere(half.spheres.y, half.at, arm);
    }
    let capsule = capsule_of(half.spheres, side_motion(half));
    let grip = capsule_load(capsule, half.at, select(-p, p, is_a), arm * cross(n, p));
    let turning = dot(grip.turning, grip.turning) * capsule.inverse_inertia;
    let rolling = dot(grip.rolling, grip.rolling) * inverse_roll(half.spheres);
    return pressed_on_capsule(capsule_rod(half.spheres.x)) * (capsule.inverse_mass + turning + rolling);
}

// Upper bound of the friction impulse, from the normal impulse of the collision and from the contact force.
fn limit_of(slot: vec2u, pair: vec2u, a: Side, b: Side, found: Touch, approach: f32, b_moves: bool) -> f32 {
    let overlap = found.overlap;
    var limit = 0.0;
    let in_collisions = collision_friction_of(pair.x, pair.y);
    let in_contacts = coulomb_friction_of(pair.x, pair.y);
    if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
        // Collisions are always listed when this is not 0, so the record exists.
        if in_collisions > 0.0 {
            limit = in_collisions * impulse_at(record_of(slot)).even;
        }
    }
    if (overlap > 0.0) & (in_contacts > 0.0) {
        if has_force(overlap, approach, smaller_radius(a.radius, b.radius, b_moves), pair.x, pair.y) {
            let pressure = pressure_of(overlap, approach);
            let force = max(pressure, 0.0) / (a.inverse_mass + b.inverse_mass);
            limit += in_contacts * step.dt * force;
        }
    }
    return limit;
}

// The friction impulse of a list entry. `row` is the mover of the list. The impulse is 0 where there is none.
fn friction_impulse_of(row: u32, slot: vec2u) -> FrictionImpulse {
    let entry = entry_at(slot);
    let pair = ordered(row, entry_id(entry));
    var a = contact_side(pair.x, 0.0);
    var b = contact_side(pair.y, 0.0);
    let a_poise = side_motion_from(a, origin_of(a));
    let b_poise = side_motion_from(b, origin_of(a));
    let by_vertex = meets_by_vertex(a, b, a_poise, entry_feature(entry));
    let found = signed_touch(a, b, a_poise, b_poise, entry_feature(entry), by_vertex);
    var friction = FrictionImpulse(vec3f(0.0), found.n, vec2f(0.0), vec2f(found.a, found.b), pair.x);
    if found.overlap == NO_CONTACT_LINE {
        return friction;
    }
    if RODS {
        a.at = select(a.at, found.a, a.id >= step.spheres);
        b.at = select(b.at, found.b, (b.id >= step.spheres) & (b.kind != STATIC));
    }
    let b_moves = pair.y < step.spheres + step.rods;
    let a_side = friction_side(a);
    let b_side = moving_side(friction_side(b), pair.x, pair.y, found);
    let approach = dot(a_side.velocity - b_side.velocity, found.n);
    friction.arms = arms_of(a_side, b_side, found.overlap, b_moves);
    let t = slip_of(a_side, b_side, friction.arms, found.n, approach);
    let speed = length(t);
    let limit = limit_of(slot, pair, a_side, b_side, found, approach, b_moves);
    if (speed <= 0.0) | (limit <= 0.0) {
        return friction;
    }
    let p = t / speed;
    // Gt of docs/physics section 3.9.
    let gt = slip_inverse_mass_of(a, found.n, p, friction.arms.x, true)
        + slip_inverse_mass_of(b, found.n, p, friction.arms.y, false);
    friction.impulse = min(limit, speed / gt) * p;
    return friction;
}
