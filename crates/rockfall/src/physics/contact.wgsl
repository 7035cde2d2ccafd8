// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/geometry.wgsl

// The contact law (physics.md section 4), and going through the pair lists.

const LOOK: u32 = 32u;

// Entries are gone through four at a time, so that memory is asked for all of them at once. Past the last one it is repeated.
fn four_entries(first: vec2u, e: u32, count: u32) -> vec4u {
    let rows = first.x + min(vec4u(e, e + 1u, e + 2u, e + 3u), vec4u(count - 1u));
    return vec4u(lists[rows.x][first.y], lists[rows.y][first.y], lists[rows.z][first.y], lists[rows.w][first.y]);
}

// The bits of those of four that are there and for which it is true.
fn which(yes: vec4<bool>, e: u32, count: u32) -> u32 {
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), yes & (vec4u(e, e + 1u, e + 2u, e + 3u) < vec4u(count)));
    return bits.x | bits.y | bits.z | bits.w;
}

// Which of LOOK entries from `begin` on have one of these bits. They are looked for first and worked out then, so that neighbouring
// threads, whose lists differ, do so together.
fn entries_with(bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + LOOK); e += 4u) {
        let marked = (four_entries(first, e, count) & vec4u(bits)) != vec4u(0u);
        found |= which(marked, e, count) << (e - begin);
    }
    return found;
}

// Positions and radii of the spheres of those of four entries for which it is true; else that of sphere 0, for nothing.
struct Four {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

fn four_spheres(entries: vec4u, are_asked: vec4<bool>) -> Four {
    let at = select(vec4u(0u), entries & vec4u(ENTRY_ID_MASK), are_asked);
    return Four(state[position_at(at.x)], state[position_at(at.y)], state[position_at(at.z)], state[position_at(at.w)]);
}

// Squares of distances are compared with a little slack, which leaves pairs near the edge to the test that counts: what it says
// must not depend on whether an entry has a bit already, for bits are lost when lists are made.
const SLACK: f32 = 1.00001;

// Which of four spheres are so close to one that they may touch.
fn close(own: vec4f, four: Four) -> vec4<bool> {
    let a = four.a.xyz - own.xyz;
    let b = four.b.xyz - own.xyz;
    let c = four.c.xyz - own.xyz;
    let d = four.d.xyz - own.xyz;
    let reach = vec4f(own.w) + vec4f(four.a.w, four.b.w, four.c.w, four.d.w);
    return vec4f(dot(a, a), dot(b, b), dot(c, c), dot(d, d)) < SLACK * reach * reach;
}

// Which of LOOK entries from `begin` on are close to a sphere, have one of these bits or are no spheres. Of the others alone
// the position is read: what costs most here is memory from many places at once.
fn entries_near(own: vec4f, bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + LOOK); e += 4u) {
        let entries = four_entries(first, e, count);
        let asked = ((entries & vec4u(bits)) == vec4u(0u)) & ((entries & vec4u(ENTRY_ID_MASK)) < vec4u(step.spheres));
        found |= which(!asked | close(own, four_spheres(entries, asked)), e, count) << (e - begin);
    }
    return found;
}

// Rods have many neighbours and few contacts: these are looked for first and worked out then, by neighbouring threads, whose lists
// differ, together.

// Of those of LOOK entries of a sphere from `begin` on that are asked for, all but rods that have none of these bits and do not touch it.
fn but_rods_apart(sphere: u32, own: vec4f, bits: u32, first: vec2u, begin: u32, count: u32, asked: u32) -> u32 {
    var kept = asked;
    for (var e = begin; e < min(count, begin + LOOK); e++) {
        let entry = entry_at(slot_at(first, e));
        let id = entry_id(entry);
        if ((asked >> (e - begin) & 1u) != 0u) & ((entry & bits) == 0u) & (id >= step.spheres) & (id - step.spheres < step.rods) {
            if touch_sphere_rod(sphere, own, bar_of(id - step.spheres)).overlap <= 0.0 {
                kept &= ~(1u << (e - begin));
            }
        }
    }
    return kept;
}

// Of LOOK entries of a rod from `begin` on those that have one of these bits or touch it.
fn touching_rod(rod: u32, own: Bar, bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + LOOK); e++) {
        let entry = entry_at(slot_at(first, e));
        var touches = (entry & bits) != 0u;
        if !touches {
            touches = touch_bar(rod, own, entry_id(entry), entry_feature(entry)).overlap > 0.0;
        }
        found |= u32(touches) << (e - begin);
    }
    return found;
}

// What is read of an entry while the one before it is worked out: memory takes longer to answer than that.
struct Met {
    entry: u32,
    // The rows of a sphere; of what is none, those of sphere 0.
    place: vec4f,
    velocity: vec4f,
    momentum: vec4f,
}

// The first of those that are left of LOOK entries from `begin` on; where none is left, any.
fn meet(first: vec2u, begin: u32, rest: u32) -> Met {
    let entry = entry_at(slot_at(first, begin + select(0u, firstTrailingBit(rest), rest != 0u)));
    return met(entry, rest != 0u);
}

fn met(entry: u32, is_needed: bool) -> Met {
    let id = select(0u, entry_id(entry), is_needed & (entry_id(entry) < step.spheres));
    return Met(entry, state[position_at(id)], state[velocity_at(id)], state[momentum_at(id)]);
}

// Two spheres, as the first sees it. Where the centres coincide the normal points up from the sphere of lower index to the other.
fn touch_two(sphere: u32, own: vec4f, other: u32, place: vec4f) -> Touch {
    let distance = place.xyz - own.xyz;
    var up = vec3f(0.0, 1.0, 0.0);
    if dot(distance, distance) <= TINY {
        up.y = select(-1.0, 1.0, ordered(sphere, other).x == sphere);
    }
    return touch_at(distance, own.w + place.w, 0.0, 0.0, up);
}

// One side of a contact. What cannot move has inverse mass 0 and inverse inertia 0; a static object is at rest besides.
struct Side {
    velocity: vec3f,
    inverse_mass: f32,
    spin: vec3f,
    inverse_inertia: f32,
    radius: f32,
}

fn sphere_side(place: vec4f, velocity: vec4f, momentum: vec4f) -> Side {
    let inverse_inertia = select(0.0, momentum.w, velocity.w > 0.0);
    return Side(velocity.xyz, velocity.w, momentum.xyz * momentum.w, inverse_inertia, place.w);
}

// The point of a rod at a parameter: (2.6) and (2.7). A fixed end is at rest there: its surface velocity is not the rod's.
fn rod_side(rod: u32, at: f32) -> Side {
    let ends = rod_ends(rod);
    let v1 = state[velocity_at(ends.x)];
    let v2 = state[velocity_at(ends.y)];
    let l1 = state[momentum_at(ends.x)];
    let l2 = state[momentum_at(ends.y)];
    let s = select(0.0, 1.0 - at, v1.w > 0.0);
    let t = select(0.0, at, v2.w > 0.0);
    return Side(
        s * v1.xyz + t * v2.xyz,
        s * s * v1.w + t * t * v2.w,
        s * l1.w * l1.xyz + t * l2.w * l2.xyz,
        s * s * l1.w + t * t * l2.w,
        rod_radius(rod),
    );
}

fn static_side() -> Side {
    return Side(vec3f(0.0), 0.0, vec3f(0.0), 0.0, 0.0);
}

// That of what is no sphere.
fn other_side(id: u32, at: f32) -> Side {
    if RODS & (id - step.spheres < step.rods) {
        return rod_side(id - step.spheres, at);
    }
    return static_side();
}

struct ContactForce {
    // On A; B gets the opposite.
    force: vec3f,
    // On a side of arm 1.
    couple: vec3f,
    arm_a: f32,
    arm_b: f32,
}

// Smaller radius of a contact; boxes and polygons have none.
fn smaller_radius(a: f32, b: f32, b_moves: bool) -> f32 {
    return select(a, min(a, b), b_moves);
}

// The approach velocity above which a contact of this smaller radius collides: erratum E19.
fn collision_velocity(radius: f32) -> f32 {
    return max(step.activation_threshold * radius, 2.0 * step.gravity_size * step.dt);
}

// Where the sides of a contact touch: arms to one common point, so that the pair's angular momentum is kept.
fn arms_of(a_side: Side, b_side: Side, overlap: f32, b_moves: bool) -> vec2f {
    return vec2f(a_side.radius - select(overlap, 0.5 * overlap, b_moves), select(0.0, b_side.radius - 0.5 * overlap, b_moves));
}

// The slip at the contact point, t = uB - uA without what it has along n, to which spins add nothing; 0 where it is only the rounding
// of what it is the difference of: the square root of the friction law would make a thousandth of it. The sum of both velocities
// tells how large they are, and is cheaper than each; opposite ones close or slip.
fn slip_of(a_side: Side, b_side: Side, arms: vec2f, n: vec3f, approach: f32) -> vec3f {
    let relative = a_side.velocity - b_side.velocity;
    let t = approach * n - relative - cross(arms.x * a_side.spin + arms.y * b_side.spin, n);
    let sum = a_side.velocity + b_side.velocity;
    let rounded = ROUNDED * ROUNDED * (dot(sum, sum) + approach * approach);
    return select(t, vec3f(0.0), dot(t, t) <= max(TINY, rounded));
}

// Whether a pair makes a contact force. While collisions are on it does not where it separates fast, which is its rebound, nor where
// the overlap began within this step, which the next one's collisions will find.
fn has_force(overlap: f32, approach: f32, radius: f32) -> bool {
    let threshold = collision_velocity(radius);
    let fresh = (approach > threshold) & (overlap < 2.0 * approach * step.dt);
    return ((step.flags & FLAG_COLLISIONS) == 0u) | !(fresh | (approach < -threshold));
}

// Repulsion and damping per reduced mass: (2.18, 2.19).
fn pressure_of(overlap: f32, approach: f32) -> f32 {
    let press = step.contact_force * overlap + step.contact_damping * approach;
    return select(max(press, 0.0), press, (step.flags & FLAG_PULL) != 0u);
}

// `b` is the id of B. The masses must not both be infinite.
fn contact_force(a_side: Side, b_side: Side, touch: Touch, b: u32) -> ContactForce {
    let b_moves = b < step.spheres + step.rods;
    let n = touch.n;
    let overlap = touch.overlap;
    let inverse_mass = a_side.inverse_mass + b_side.inverse_mass;
    let reduced_mass = 1.0 / inverse_mass;
    let approach = dot(a_side.velocity - b_side.velocity, n);
    let radius = smaller_radius(a_side.radius, b_side.radius, b_moves);
    if !has_force(overlap, approach, radius) {
        return ContactForce(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    }
    let press = pressure_of(overlap, approach);
    let arms = arms_of(a_side, b_side, overlap, b_moves);
    var friction = vec3f(0.0);
    // With Coulomb's friction there are impulses in its place; asked together for the reason in objects.wgsl.
    if (step.coulomb_friction <= 0.0) & (overlap > 0.0) {
        let t = slip_of(a_side, b_side, arms, n, approach);
        let tt = dot(t, t);
        if tt > 0.0 {
            // No more than half of what would stop the slip within the step, or the integration is not stable.
            let turning = arms.x * arms.x * a_side.inverse_inertia + arms.y * arms.y * b_side.inverse_inertia;
            let most = 0.5 / ((inverse_mass + turning) * step.dt);
            friction = min(step.friction * reduced_mass * overlap / sqrt(sqrt(tt)), most) * t;
        }
    }
    return ContactForce(friction - press * reduced_mass * n, cross(n, friction), arms.x, arms.y);
}
