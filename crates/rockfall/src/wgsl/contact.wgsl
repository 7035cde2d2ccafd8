// The contact law (physics.md section 4), and how the pair lists are read.

// Place of entry e of a mover among the entries.
fn slot_of(mover: u32, entry: u32) -> u32 {
    return lists[step.slices_at + mover / SLICE] + entry * SLICE + mover % SLICE;
}

// Entries in a mover's list.
fn count_of(mover: u32) -> u32 {
    return lists[mover] & LIST_COUNT_MASK;
}

fn entry_at(slot: u32) -> u32 {
    return lists[step.entries_at + slot];
}

fn entry_id(entry: u32) -> u32 {
    return entry & ENTRY_ID_MASK;
}

fn entry_feature(entry: u32) -> u32 {
    return entry >> ENTRY_ID_BITS & ENTRY_FEATURE_MASK;
}

// One side of a contact. What cannot move has inverse mass 0 and is at rest.
struct Side {
    velocity: vec3f,
    inverse_mass: f32,
    spin: vec3f,
    radius: f32,
}

fn sphere_side(sphere: u32) -> Side {
    let velocity = state[velocity_at(sphere)];
    return Side(velocity.xyz, velocity.w, spin_of(sphere), state[position_at(sphere)].w);
}

// The point of a rod at a parameter: (2.6) and (2.7).
fn rod_side(rod: u32, at: f32) -> Side {
    let ends = rod_ends(rod);
    let v1 = state[velocity_at(ends.x)];
    let v2 = state[velocity_at(ends.y)];
    return Side(
        (1.0 - at) * v1.xyz + at * v2.xyz,
        (1.0 - at) * (1.0 - at) * v1.w + at * at * v2.w,
        (1.0 - at) * spin_of(ends.x) + at * spin_of(ends.y),
        rod_radius(rod),
    );
}

fn static_side() -> Side {
    return Side(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
}

fn side_at(id: u32, at: f32) -> Side {
    if id < step.spheres {
        return sphere_side(id);
    }
    if RODS & (id - step.spheres < step.rods) {
        return rod_side(id - step.spheres, at);
    }
    return static_side();
}

struct ContactForce {
    // On A; B gets the opposite.
    force: vec3f,
    couple_a: vec3f,
    couple_b: vec3f,
}

// Smaller radius of a contact; boxes and polygons have none.
fn smaller_radius(a: f32, b: f32, b_moves: bool) -> f32 {
    return select(a, min(a, b), b_moves);
}

// `b` is the id of B. The masses must not both be infinite.
fn contact_force(a_side: Side, b_side: Side, touch: Touch, b: u32) -> ContactForce {
    let movers = step.spheres + step.rods;
    let b_moves = b < movers;
    let n = touch.n;
    let overlap = touch.overlap;
    let reduced_mass = 1.0 / (a_side.inverse_mass + b_side.inverse_mass);
    let approach = dot(a_side.velocity - b_side.velocity, n);
    let threshold = step.activation_threshold * smaller_radius(a_side.radius, b_side.radius, b_moves);
    // An overlap begun within this step is left to the next step's collisions.
    let fresh = ((step.flags & FLAG_COLLISIONS) != 0u) & (approach > threshold) & (overlap < 2.0 * approach * step.dt);
    // What came through a polygon from behind is not shot out.
    let leaves = (b >= movers + step.boxes) & (approach < -threshold);
    if fresh | leaves {
        return ContactForce(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    }
    var press = step.contact_force * overlap + step.contact_damping * approach;
    if (step.flags & FLAG_PULL) == 0u {
        press = max(press, 0.0);
    }
    // The arms meet in one point, so that the pair's angular momentum is kept.
    let arm_a = a_side.radius - select(overlap, 0.5 * overlap, b_moves);
    let arm_b = select(0.0, b_side.radius - 0.5 * overlap, b_moves);
    let surface_a = a_side.velocity + cross(a_side.spin, arm_a * n);
    let surface_b = b_side.velocity - cross(b_side.spin, arm_b * n);
    let slip = surface_b - surface_a;
    let t = slip - n * dot(slip, n);
    let tt = dot(t, t);
    var friction = vec3f(0.0);
    if tt > TINY {
        var per_velocity = step.friction * reduced_mass * overlap / sqrt(sqrt(tt));
        // Coulomb's cap, |F| <= mu_c N.
        if step.coulomb_friction > 0.0 {
            per_velocity = min(per_velocity, step.coulomb_friction * max(press, 0.0) * reduced_mass / sqrt(tt));
        }
        friction = per_velocity * t;
    }
    let couple = cross(n, friction);
    return ContactForce(friction - press * reduced_mass * n, arm_a * couple, arm_b * couple);
}
