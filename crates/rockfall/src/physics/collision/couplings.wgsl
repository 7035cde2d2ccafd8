// requires model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/collision/impulses.wgsl
// requires physics/contact.wgsl physics/pairs.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl
// requires step/collisions/report_clusters.wgsl

// Finds the neighbours of a collision, which are other collisions that share a body with it, and the couplings
// (docs/physics section 3.7). A coupling is the change of the approach velocity of the collision per unit of the
// neighbour's impulse. They are collected in the order of the lists, those of side A first.

// Record numbers and couplings of the neighbours.
var<private> near: array<vec2u, NEIGHBOURS>;
// The number of neighbours. It may exceed NEIGHBOURS.
var<private> near_count: u32;
// The coupling of the collision with itself.
var<private> own_coupling: f32;
// GATHERED_* bits.
var<private> gathered: u32;

fn begin_couplings() {
    near_count = 0u;
    own_coupling = 0.0;
    gathered = 0u;
}

fn add_coupling(r: u32, coupling: f32) {
    if near_count < NEIGHBOURS {
        near[near_count] = vec2u(r, bitcast<u32>(coupling));
    }
    near_count += 1u;
}

// Collects the coupling of collision `number` with collision r, which may be the same.
fn put_coupling(r: u32, number: u32, coupling: f32) {
    if r == number {
        own_coupling += coupling;
    } else {
        add_coupling(r, coupling);
    }
}

// Writes the collected couplings to record r. If there is no room for all neighbours, both sides are gathered.
fn put_couplings(r: u32, is_only: bool) {
    if near_count > NEIGHBOURS {
        near_count = 0u;
        own_coupling = 0.0;
        gathered = GATHERED_A | GATHERED_B;
    }
    if gathered != 0u {
        need_dispatches();
    }
    let bits = gathered | select(0u, ONLY, is_only);
    var restitution = 0.0;
    if MATERIALS {
        let k = record_at(r);
        restitution = restitution_of(k.a_id, k.b_id);
    }
    collisions[row_at(r, 2u)] = vec4u(bits, bitcast<u32>(own_coupling), near_count, bitcast<u32>(restitution));
    for (var place = 0u; place < near_count; place += 2u) {
        collisions[row_at(r, 4u + place / 2u)] = vec4u(near[place], near[min(place + 1u, near_count - 1u)]);
    }
}

// What a collision does to a body, for the couplings: a sphere, or a capsule if `rod` is not NONE.
struct Coupled {
    sphere: u32,
    rod: u32,
    capsule: Capsule,
    // Torque on the capsule per unit of the impulse.
    torque: vec3f,
    // A factor of all couplings: the sign of the side and, for a sphere, its share of the impulse times its inverse mass.
    times: f32,
}

fn coupling_with(k: Record, body: Coupled, row: u32, r: u32) -> f32 {
    let l = record_at(r);
    if RODS & (body.rod != NONE) {
        let is_a = l.a_id == row;
        let at = at_on_capsule(body.rod, row, select(l.b, l.a, is_a));
        let turning = dot(body.torque, torque_at(body.capsule, at, l.n)) * body.capsule.inverse_inertia;
        return body.times * select(1.0, -1.0, is_a) * fma(body.capsule.inverse_mass, dot(k.n, l.n), turning);
    }
    return body.times * part_on(body.sphere, row, r) * dot(l.n, k.n);
}

// Collects the couplings on a body.
fn couple_body(k: Record, number: u32, body: Coupled) {
    var rods = vec2u(0u);
    if RODS {
        rods = rods_of(body.sphere);
    }
    for (var place = 0u; place < body_rows(body.rod, rods); place++) {
        let row = body_row(body.sphere, body.rod, rods, place);
        // Once there are too many neighbours, their exact number does not matter.
        if !has_collisions(row) | (near_count > NEIGHBOURS) {
            continue;
        }
        let count = count_of(row);
        let first = first_of(row);
        for (var begin = 0u; (begin < count) & (near_count <= NEIGHBOURS); begin += ENTRIES_PER_MASK) {
            for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
                let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
                put_coupling(r, number, coupling_with(k, body, row, r));
            }
        }
    }
}

// Whether the change of velocity of a sphere is gathered even if there is room for all neighbours. This is so for spheres
// of networks only. It must not depend on whether a sphere is large: the brute-force broad phase does not know large
// spheres, and the results must be bitwise identical.
fn is_gathered(sphere: u32) -> bool {
    if !RODS | (inverse_mass(sphere) <= 0.0) {
        return false;
    }
    return network_of(sphere) != NO_NETWORK;
}

// Collects the couplings of one side. `side` is 1 for A, -1 for B.
fn couple_side(k: Record, number: u32, half: ContactSide, side: f32) {
    if half.kind == STATIC {
        return;
    }
    let is_rod = RODS & (half.kind == ROD);
    if is_gathered(half.spheres.x) | (is_rod && is_gathered(half.spheres.y)) {
        gathered |= select(GATHERED_B, GATHERED_A, side > 0.0);
        return;
    }
    var body = Coupled(half.spheres.x, NONE, Capsule(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0), vec3f(0.0), side);
    if RODS & (half.kind == CAPSULE) {
        body.rod = capsule_rod(half.spheres.x);
        body.capsule = capsule_of(half.spheres, side_motion(half));
        body.torque = torque_at(body.capsule, half.at, k.n);
    }
    for (var end = 0u; end < select(1u, 2u, is_rod); end++) {
        if half.kind != CAPSULE {
            let one = side_end(half, end);
            body.sphere = one.sphere;
            body.times = side * one.share * inverse_mass(one.sphere);
        }
        if body.times != 0.0 {
            couple_body(k, number, body);
        }
    }
}

// Side A (0) or B (1) of a collision.
fn side_of_record(k: Record, side: u32) -> ContactSide {
    let is_b = side == 1u;
    return contact_side(select(k.a_id, k.b_id, is_b), select(k.a, k.b, is_b));
}

// Finds and writes all couplings of a collision that is left to the sweeps.
fn find_couplings(k: Record, number: u32, is_only: bool) {
    for (var side = 0u; side < 2u; side++) {
        couple_side(k, number, side_of_record(k, side), select(1.0, -1.0, side == 1u));
    }
    put_couplings(number, is_only);
}
