// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl
// requires physics/fine.wgsl physics/geometry.wgsl physics/round_pair.wgsl physics/pairs.wgsl physics/period.wgsl
// requires physics/walls.wgsl

// The contact law (docs/physics section 4), and functions that search the pair lists.

// Number of entries that are tested before any of them is evaluated: one per bit of a mask.
const ENTRIES_PER_MASK: u32 = 32u;

// Reads four entries at once, so that their memory requests overlap. Past the end of the list, it repeats the last entry.
fn four_entries(first: vec2u, e: u32, count: u32) -> vec4u {
    let rows = first.x + min(vec4u(e, e + 1u, e + 2u, e + 3u), vec4u(count - 1u));
    return vec4u(lists[rows.x][first.y], lists[rows.y][first.y], lists[rows.z][first.y], lists[rows.w][first.y]);
}

// Bit mask of those of four entries from `e` on that exist and for which `yes` holds.
fn which(yes: vec4<bool>, e: u32, count: u32) -> u32 {
    let bits = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), yes & (vec4u(e, e + 1u, e + 2u, e + 3u) < vec4u(count)));
    return bits.x | bits.y | bits.z | bits.w;
}

// Which of ENTRIES_PER_MASK entries from `begin` on have one of `bits`. Finding the entries first and evaluating them
// afterwards lets neighbouring threads, whose lists differ, evaluate at the same time.
fn entries_with(bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + ENTRIES_PER_MASK); e += 4u) {
        let marked = (four_entries(first, e, count) & vec4u(bits)) != vec4u(0u);
        found |= which(marked, e, count) << (e - begin);
    }
    return found;
}

// Positions and radii of four spheres.
struct Four {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

// The spheres of four entries. Where `are_needed` is false, it reads sphere 0, and the result is not used.
fn four_spheres(entries: vec4u, are_needed: vec4<bool>) -> Four {
    let at = select(vec4u(0u), entries & vec4u(ENTRY_ID_MASK), are_needed);
    return Four(state[position_at(at.x)], state[position_at(at.y)], state[position_at(at.z)], state[position_at(at.w)]);
}

// Which of four spheres are close enough to a sphere to touch it.
fn close(own: vec4f, four: Four) -> vec4<bool> {
    let a = nearest_image(four.a.xyz - own.xyz);
    let b = nearest_image(four.b.xyz - own.xyz);
    let c = nearest_image(four.c.xyz - own.xyz);
    let d = nearest_image(four.d.xyz - own.xyz);
    var reach = vec4f(own.w) + vec4f(four.a.w, four.b.w, four.c.w, four.d.w);
    if DOUBLE {
        let far = vec4f(largest_coordinate(four.a), largest_coordinate(four.b), largest_coordinate(four.c), largest_coordinate(four.d));
        reach += LOW_PARTS * max(far, vec4f(largest_coordinate(own)));
    }
    return vec4f(dot(a, a), dot(b, b), dot(c, c), dot(d, d)) < SLACK * reach * reach;
}

// Which of ENTRIES_PER_MASK entries from `begin` on are close to a sphere, have one of `bits`, or are not spheres. Positions
// are read only for spheres without these bits, because reads from scattered addresses are the most expensive part here.
fn entries_near(own: vec4f, bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + ENTRIES_PER_MASK); e += 4u) {
        let entries = four_entries(first, e, count);
        let needed = ((entries & vec4u(bits)) == vec4u(0u)) & ((entries & vec4u(ENTRY_ID_MASK)) < vec4u(step.spheres));
        found |= which(!needed | close(own, four_spheres(entries, needed)), e, count) << (e - begin);
    }
    return found;
}

// Rods have many neighbours and few contacts. So contacts are found first and evaluated afterwards, which lets neighbouring
// threads, whose lists differ, evaluate at the same time.

// Removes rods from `given`, a mask of ENTRIES_PER_MASK entries of a sphere from `begin` on: those that have none of `bits` and
// do not touch the sphere.
fn without_distant_rods(sphere: u32, own: vec4f, bits: u32, first: vec2u, begin: u32, count: u32, given: u32) -> u32 {
    var kept = given;
    for (var e = begin; e < min(count, begin + ENTRIES_PER_MASK); e++) {
        let entry = entry_at(slot_at(first, e));
        let id = entry_id(entry);
        if (((given >> (e - begin)) & 1u) != 0u) & ((entry & bits) == 0u)
            & (id >= step.spheres) & (id - step.spheres < step.rods) {
            if touch_static_or_rod(sphere, id, own).overlap <= 0.0 {
                kept &= ~(1u << (e - begin));
            }
        }
    }
    return kept;
}

// Which of ENTRIES_PER_MASK entries of a rod from `begin` on have one of `bits` or touch the rod.
fn touching_rod(rod: u32, own: Bar, bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var found = 0u;
    for (var e = begin; e < min(count, begin + ENTRIES_PER_MASK); e++) {
        let entry = entry_at(slot_at(first, e));
        var touches = (entry & bits) != 0u;
        if !touches {
            touches = touch_bar(rod, own, entry_id(entry), entry_feature(entry)).overlap > 0.0;
        }
        found |= u32(touches) << (e - begin);
    }
    return found;
}

// Data of an entry. It is read while the previous entry is evaluated, because a memory request takes longer than the
// evaluation.
struct LoadedEntry {
    entry: u32,
    // The rows of the sphere; those of sphere 0 when the entry is not a sphere.
    place: vec4f,
    velocity: vec4f,
    momentum: vec4f,
}

// Reads the first of the remaining entries. `rest` is a mask of ENTRIES_PER_MASK entries from `begin` on. If it is empty, the
// result is not used.
fn meet(first: vec2u, begin: u32, rest: u32) -> LoadedEntry {
    let entry = entry_at(slot_at(first, begin + select(0u, firstTrailingBit(rest), rest != 0u)));
    return load_entry(entry, rest != 0u);
}

// Reads the data of an entry. Where it is not needed, it reads sphere 0.
fn load_entry(entry: u32, is_needed: bool) -> LoadedEntry {
    let id = select(0u, entry_id(entry), is_needed & (entry_id(entry) < step.spheres));
    return LoadedEntry(entry, state[position_at(id)], state[velocity_at(id)], state[momentum_at(id)]);
}

// Contact of two spheres, with the normal from `sphere` to `other`. Where the centres coincide, the normal is +y from the
// sphere that was added first to the other.
fn touch_two(sphere: u32, own: vec4f, other: u32, place: vec4f) -> Touch {
    if DOUBLE {
        let pair = ordered(sphere, other);
        var found = touch_spheres_finely(fine_between(pair.x, pair.y), own.w, place.w);
        found.n = select(-found.n, found.n, pair.x == sphere);
        return found;
    }
    let distance = place.xyz - own.xyz;
    var up = vec3f(0.0, 1.0, 0.0);
    if dot(distance, distance) <= TINY {
        up.y = select(-1.0, 1.0, ordered(sphere, other).x == sphere);
    }
    return touch_at(distance, own.w + place.w, 0.0, 0.0, up);
}

// One side of a contact. Inverse mass and inverse inertia are 0 for fixed spheres, boxes and polygons. Velocity and spin are 0
// for boxes and polygons that do not move.
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

// The side of a rod at a parameter, by (2.6) and (2.7). A fixed end is at rest: the velocity of its surface is not that of the
// rod.
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

// The side of an object that is not a sphere. `at` is the parameter on a rod.
fn other_side(id: u32, at: f32) -> Side {
    if RODS & (id - step.spheres < step.rods) {
        return rod_side(id - step.spheres, at);
    }
    return static_side();
}

// The side of an object. `at` is the parameter on a rod.
fn side_of(id: u32, at: f32) -> Side {
    if id < step.spheres {
        return sphere_side(state[position_at(id)], state[velocity_at(id)], state[momentum_at(id)]);
    }
    return other_side(id, at);
}

// The end of the arm of A, which is at a parameter if it is a rod: the contact point on the surface of a box or polygon.
fn contact_point(a: u32, at: f32, overlap: f32, n: vec3f) -> vec3f {
    if RODS & (a >= step.spheres) {
        let ends = rod_ends(a - step.spheres);
        let place = mix(state[position_at(ends.x)].xyz, state[position_at(ends.y)].xyz, at);
        return place + (rod_radius(a - step.spheres) - overlap) * n;
    }
    let own = state[position_at(a)];
    return own.xyz + (own.w - overlap) * n;
}

// The side of B. A moving wall has the velocity of the contact point.
fn second_side(a: u32, b: u32, found: Touch) -> Side {
    return moving_side(side_of(b, found.b), a, b, found);
}

// The velocity of the image of sphere b that is nearest to sphere a, relative to b itself.
fn image_velocity(a: u32, b: u32) -> vec3f {
    return velocity_below(round(boxes_in(fine_apart(a, b).high)));
}

// The side of B, with the motion of the contact point if B is a wall. In a sheared scene B has the velocity of its nearest image.
fn moving_side(plain: Side, a: u32, b: u32, found: Touch) -> Side {
    var half = plain;
    if SHEARED {
        half.velocity += image_velocity(a, b);
    }
    if WALLS {
        if b >= step.spheres + step.rods {
            let wall = wall_of(b);
            half.velocity = velocity_of_surface(wall, contact_point(a, found.a, found.overlap, found.n), found.n);
            half.spin = wall.spin;
        }
    }
    return half;
}

struct ContactForce {
    // Force on A. B gets the opposite.
    force: vec3f,
    // Torque per unit length of the arm. The torque on a side is `torque_per_arm` times its arm.
    torque_per_arm: vec3f,
    arm_a: f32,
    arm_b: f32,
}

// Smaller radius of a contact. Boxes and polygons have no radius (`b_moves` is false).
fn smaller_radius(a: f32, b: f32, b_moves: bool) -> f32 {
    return select(a, min(a, b), b_moves);
}

// Size of the acceleration of an object by everything but contacts, as `synchronise` found it.
fn free_acceleration_of(id: u32) -> f32 {
    if id < step.spheres {
        return float_at(step.free_at + id);
    }
    if RODS & (id - step.spheres < step.rods) {
        let ends = rod_ends(id - step.spheres);
        return max(float_at(step.free_at + ends.x), float_at(step.free_at + ends.y));
    }
    return 0.0;
}

// Size of the acceleration of a wall at the centre of A. For a rod, the greater one of its ends.
fn wall_acceleration_at(a: u32, b: u32) -> f32 {
    let wall = wall_of(b);
    if RODS & (a >= step.spheres) {
        let ends = rod_ends(a - step.spheres);
        let one = acceleration_of_wall(wall, state[position_at(ends.x)].xyz);
        let two = acceleration_of_wall(wall, state[position_at(ends.y)].xyz);
        return max(length(one), length(two));
    }
    return length(acceleration_of_wall(wall, state[position_at(a)].xyz));
}

// Approach velocity above which the contact of objects a and b collides, for the smaller radius of the pair: erratum E19.
fn collision_velocity(radius: f32, a: u32, b: u32) -> f32 {
    var free = step.gravity_size;
    if FREE_TABLE {
        free = max(free_acceleration_of(a), free_acceleration_of(b));
    }
    if WALLS {
        // A wall may accelerate against the other object.
        if b >= step.spheres + step.rods {
            free += wall_acceleration_at(a, b);
        }
    }
    return max(step.activation_threshold * radius, select(2.0, 4.0, HALF_STEP) * free * step.dt);
}

// Arms of a contact. Both end in one common point, so the angular momentum of the pair is conserved.
fn arms_of(a_side: Side, b_side: Side, overlap: f32, b_moves: bool) -> vec2f {
    return vec2f(a_side.radius - select(overlap, 0.5 * overlap, b_moves), select(0.0, b_side.radius - 0.5 * overlap, b_moves));
}

// Slip at the contact point: t = uB - uA without its component along n. Spins do not contribute to that component. The result
// is 0 where the slip is only a rounding error of the velocities that are subtracted. The square root in the friction law would
// enlarge such an error to about a thousandth. The sum of both velocities measures their size and is cheaper than the size of
// each. Where opposite velocities cancel in the sum, they contribute to the approach velocity or to the slip.
fn slip_of(a_side: Side, b_side: Side, arms: vec2f, n: vec3f, approach: f32) -> vec3f {
    let relative = a_side.velocity - b_side.velocity;
    let t = approach * n - relative - cross(arms.x * a_side.spin + arms.y * b_side.spin, n);
    let sum = a_side.velocity + b_side.velocity;
    let rounded = ROUNDED * ROUNDED * (dot(sum, sum) + approach * approach);
    return select(t, vec3f(0.0), dot(t, t) <= max(TINY, rounded));
}

// Whether a pair has a contact force (docs/physics section 4.4). While collisions are switched on, there is none when the
// pair separates fast, which is its rebound, or when the overlap began within this step, because the next collision phase will
// handle it.
fn has_force(overlap: f32, approach: f32, radius: f32, a: u32, b: u32) -> bool {
    let threshold = collision_velocity(radius, a, b);
    let fresh = (approach > threshold) & (overlap < 2.0 * approach * step.dt);
    return ((step.flags & FLAG_COLLISIONS) == 0u) | !(fresh | (approach < -threshold));
}

// Repulsion and damping per reduced mass: (2.18, 2.19).
fn pressure_of(overlap: f32, approach: f32) -> f32 {
    let press = step.contact_force * overlap + step.contact_damping * approach;
    return select(max(press, 0.0), press, (step.flags & FLAG_PULL) != 0u);
}

// Contact force of two objects that overlap, by their ids `a` and `b`. The inverse masses must not both be 0.
fn contact_force(a_side: Side, b_side: Side, touch: Touch, a: u32, b: u32) -> ContactForce {
    let b_moves = b < step.spheres + step.rods;
    let n = touch.n;
    let overlap = touch.overlap;
    let inverse_mass = a_side.inverse_mass + b_side.inverse_mass;
    let reduced_mass = 1.0 / inverse_mass;
    let approach = dot(a_side.velocity - b_side.velocity, n);
    let radius = smaller_radius(a_side.radius, b_side.radius, b_moves);
    if !has_force(overlap, approach, radius, a, b) {
        return ContactForce(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    }
    let press = pressure_of(overlap, approach);
    let arms = arms_of(a_side, b_side, overlap, b_moves);
    var friction = vec3f(0.0);
    // With Coulomb friction, impulses replace the friction force. The reason for the combined condition is in objects.wgsl
    // (`adjacency`).
    if (coulomb_friction_of(a, b) <= 0.0) & (overlap > 0.0) {
        let t = slip_of(a_side, b_side, arms, n, approach);
        let tt = dot(t, t);
        if tt > 0.0 {
            // At most half of the force that would stop the slip within the step. Otherwise the integration is unstable (E25).
            let turning = arms.x * arms.x * a_side.inverse_inertia + arms.y * arms.y * b_side.inverse_inertia;
            let most = 0.5 / ((inverse_mass + turning) * step.dt);
            friction = min(friction_of(a, b) * reduced_mass * overlap / sqrt(sqrt(tt)), most) * t;
        }
    }
    return ContactForce(friction - press * reduced_mass * n, cross(n, friction), arms.x, arms.y);
}
