// requires model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/collision/impulses.wgsl
// requires physics/contact.wgsl physics/pairs.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl
// requires step/collisions/report_clusters.wgsl

// Finds the neighbours of a collision, which are other collisions that share a body with it, and the couplings
// (docs/physics.md section 3.7). A coupling is the change of the approach velocity of the collision per unit of the
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

// Collects the couplings on a single sphere. `part` is the share of the impulse of collision k that the sphere gets. `side`
// is 1 for A, -1 for B, here and below.
fn couple_sphere(k: Record, number: u32, sphere: u32, part: f32, side: f32) {
    let w = inverse_mass(sphere);
    if (w <= 0.0) | (part == 0.0) {
        return;
    }
    var rods = vec2u(0u);
    if RODS {
        rods = rods_of(sphere);
    }
    for (var r = 0u; r < 1u + rods.y; r++) {
        var row = sphere;
        if r > 0u {
            row = step.spheres + index_of(topology[rods.x + r - 1u]);
        }
        couple_sphere_row(k, number, sphere, row, side * part * w);
    }
}

fn couple_sphere_row(k: Record, number: u32, sphere: u32, row: u32, times: f32) {
    // Once there are too many neighbours, their exact number does not matter.
    if !has_collisions(row) | (near_count > NEIGHBOURS) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; (begin < count) & (near_count <= NEIGHBOURS); begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let coupling = times * part_on(sphere, row, r) * dot(record_at(r).n, k.n);
            put_coupling(r, number, coupling);
        }
    }
}

// Collects the couplings on a rigid capsule.
fn couple_capsule(k: Record, number: u32, half: ContactSide, side: f32) {
    let rod = capsule_rod(half.spheres.x);
    let capsule = capsule_of(half.spheres, side_motion(half));
    let torque = torque_at(capsule, half.at, k.n);
    for (var r = 0u; r < 3u; r++) {
        let row = select(select(half.spheres.x, half.spheres.y, r == 1u), step.spheres + rod, r == 2u);
        couple_capsule_row(k, number, capsule, torque, rod, row, side);
    }
}

fn couple_capsule_row(k: Record, number: u32, capsule: Capsule, torque: vec3f, rod: u32, row: u32, side: f32) {
    // Once there are too many neighbours, their exact number does not matter.
    if !has_collisions(row) | (near_count > NEIGHBOURS) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; (begin < count) & (near_count <= NEIGHBOURS); begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let l = record_at(r);
            let is_a = l.a_id == row;
            var at = select(l.b, l.a, is_a);
            if row < step.spheres {
                at = select(0.0, 1.0, rod_ends(rod).y == row);
            }
            let turning = dot(torque, torque_at(capsule, at, l.n)) * capsule.inverse_inertia;
            let coupling = side * select(1.0, -1.0, is_a) * fma(capsule.inverse_mass, dot(k.n, l.n), turning);
            put_coupling(r, number, coupling);
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

// Collects the couplings of one side.
fn couple_side(k: Record, number: u32, half: ContactSide, side: f32) {
    if half.kind == STATIC {
        return;
    }
    let bit = select(GATHERED_B, GATHERED_A, side > 0.0);
    if RODS & (half.kind == CAPSULE) {
        couple_capsule(k, number, half, side);
        return;
    }
    if is_gathered(half.spheres.x) | ((RODS & (half.kind == ROD)) && is_gathered(half.spheres.y)) {
        gathered |= bit;
        return;
    }
    let is_rod = RODS & (half.kind == ROD);
    for (var end = 0u; end < select(1u, 2u, is_rod); end++) {
        let part = select(1.0, select(1.0 - half.at, half.at, end == 1u), is_rod);
        couple_sphere(k, number, select(half.spheres.x, half.spheres.y, end == 1u), part, side);
    }
}

// Side A (0) or B (1) of a collision.
fn side_of_record(k: Record, side: u32) -> ContactSide {
    let is_b = side == 1u;
    return contact_side(select(k.a_id, k.b_id, is_b), select(k.a, k.b, is_b));
}

// Finds and writes all couplings of a collision that is left to the sweeps.
fn find_couplings(k: Record, number: u32, is_only: bool) {
    begin_couplings();
    for (var side = 0u; side < 2u; side++) {
        couple_side(k, number, side_of_record(k, side), select(1.0, -1.0, side == 1u));
    }
    put_couplings(number, is_only);
}
