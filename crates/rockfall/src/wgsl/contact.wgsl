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

const LOOK: u32 = 32u;

// Entries are gone through four at a time, so that memory is asked for all of them at once. Past the last one it is repeated.
fn four_entries(first: u32, e: u32, count: u32) -> vec4u {
    let places = first + min(vec4u(e, e + 1u, e + 2u, e + 3u), vec4u(count - 1u)) * SLICE;
    return vec4u(entry_at(places.x), entry_at(places.y), entry_at(places.z), entry_at(places.w));
}

// The bits of those of four that are there and for which it is true.
fn which(yes: vec4<bool>, e: u32, count: u32) -> u32 {
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), yes & (vec4u(e, e + 1u, e + 2u, e + 3u) < vec4u(count)));
    return bits.x | bits.y | bits.z | bits.w;
}

// Which of LOOK entries from `begin` on have one of these bits. They are looked for first and worked out then, so that neighbouring
// threads, whose lists differ, do so together.
fn entries_with(bits: u32, first: u32, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + LOOK); e += 4u) {
        let marked = (four_entries(first, e, count) & vec4u(bits)) != vec4u(0u);
        found |= which(marked, e, count) << (e - begin);
    }
    return found;
}

// One of four, without a place in memory that an index would need.
fn one_of(four: vec4u, at: u32) -> u32 {
    return select(select(four.x, four.y, at == 1u), select(four.z, four.w, at == 3u), at >= 2u);
}

// Positions and radii of the spheres of four entries; of what is no sphere that of `instead`.
struct Four {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

fn four_spheres(entries: vec4u, instead: u32) -> Four {
    let ids = entries & vec4u(ENTRY_ID_MASK);
    let at = select(vec4u(instead), ids, ids < vec4u(step.spheres));
    return Four(state[position_at(at.x)], state[position_at(at.y)], state[position_at(at.z)], state[position_at(at.w)]);
}

fn one_sphere(four: Four, at: u32) -> vec4f {
    return select(select(four.a, four.b, at == 1u), select(four.c, four.d, at == 3u), at >= 2u);
}

// Which of four spheres are so close to one that they touch, were the sum of the radii so many times as large.
fn close(own: vec4f, four: Four, slack: f32) -> vec4<bool> {
    let a = four.a.xyz - own.xyz;
    let b = four.b.xyz - own.xyz;
    let c = four.c.xyz - own.xyz;
    let d = four.d.xyz - own.xyz;
    let reach = vec4f(own.w) + vec4f(four.a.w, four.b.w, four.c.w, four.d.w);
    return vec4f(dot(a, a), dot(b, b), dot(c, c), dot(d, d)) < slack * reach * reach;
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
        // Coulomb's cap, |F| <= mu_c N; asked together for the reason in objects.wgsl.
        if (step.coulomb_friction > 0.0) & (overlap > 0.0) {
            per_velocity = min(per_velocity, step.coulomb_friction * max(press, 0.0) * reduced_mass / sqrt(tt));
        }
        friction = per_velocity * t;
    }
    let couple = cross(n, friction);
    return ContactForce(friction - press * reduced_mass * n, arm_a * couple, arm_b * couple);
}
