// requires model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/collision/impulses.wgsl
// requires physics/contact.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl
// requires step/collisions/report_clusters.wgsl

// Which other collisions share a body with one, and by how much a unit of their impulse changes its approach velocity
// (docs/physics.md section 3.7). They are put down in the order of the lists, those of side A first.

var<private> near: array<vec2u, NEIGHBOURS>;
var<private> near_count: u32;
// By how much a unit of its own impulse changes it.
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

// Puts down a coupling of collision `number`, with another one or with itself.
fn put_coupling(r: u32, number: u32, coupling: f32) {
    if r == number {
        own_coupling += coupling;
    } else {
        add_coupling(r, coupling);
    }
}

// Writes what was put down. Where there is no room for all, both sides are gathered.
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
    collisions[row_at(r, 2u)] = vec4u(bits, bitcast<u32>(own_coupling), near_count, 0u);
    for (var place = 0u; place < near_count; place += 2u) {
        collisions[row_at(r, 4u + place / 2u)] = vec4u(near[place], near[min(place + 1u, near_count - 1u)]);
    }
}

// Those of a sphere that is a body of its own. The impulse on it of a collision k is `sign` n times `part`.
fn couple_sphere(k: Record, number: u32, sphere: u32, part: f32, side: f32) {
    let w = inverse_mass(sphere);
    if (w <= 0.0) | (part == 0.0) {
        return;
    }
    couple_sphere_row(k, number, sphere, sphere, side * part * w);
    if RODS {
        let rods = rods_of(sphere);
        for (var r = 0u; r < rods.y; r++) {
            couple_sphere_row(k, number, sphere, step.spheres + index_of(topology[rods.x + r]), side * part * w);
        }
    }
}

fn couple_sphere_row(k: Record, number: u32, sphere: u32, row: u32, times: f32) {
    // Where there is no room for all it does not matter how many more there are.
    if !has_collisions(row) | (near_count > NEIGHBOURS) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; (begin < count) & (near_count <= NEIGHBOURS); begin += LOOK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let coupling = times * part_on(sphere, row, r) * dot(record_at(r).n, k.n);
            put_coupling(r, number, coupling);
        }
    }
}

// Those of a rigid capsule, hit at a parameter.
fn couple_capsule(k: Record, number: u32, half: Half, side: f32) {
    let rod = capsule_rod(half.spheres.x);
    let capsule = capsule_of(half.spheres, poise_of(half));
    let torque = torque_at(capsule, half.at, k.n);
    couple_capsule_row(k, number, capsule, torque, rod, half.spheres.x, side);
    couple_capsule_row(k, number, capsule, torque, rod, half.spheres.y, side);
    couple_capsule_row(k, number, capsule, torque, rod, step.spheres + rod, side);
}

fn couple_capsule_row(k: Record, number: u32, capsule: Capsule, torque: vec3f, rod: u32, row: u32, side: f32) {
    // Where there is no room for all it does not matter how many more there are.
    if !has_collisions(row) | (near_count > NEIGHBOURS) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; (begin < count) & (near_count <= NEIGHBOURS); begin += LOOK) {
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

// A sphere whose change of velocity is gathered whatever it collides with: only in a network. How large a sphere is must not decide, for
// brute force does not know, and the bits are to be the same.
fn is_gathered(sphere: u32) -> bool {
    if !RODS | (inverse_mass(sphere) <= 0.0) {
        return false;
    }
    return network_of(sphere) != NO_NETWORK;
}

// Those of one side; `side` is 1 for A, -1 for B.
fn couple_side(k: Record, number: u32, half: Half, side: f32) {
    if half.kind == STATIC {
        return;
    }
    let bit = select(GATHERED_B, GATHERED_A, side > 0.0);
    if RODS & (half.kind == CAPSULE) {
        couple_capsule(k, number, half, side);
        return;
    }
    if is_gathered(half.spheres.x) | (RODS & (half.kind == ROD) && is_gathered(half.spheres.y)) {
        gathered |= bit;
        return;
    }
    if RODS & (half.kind == ROD) {
        couple_sphere(k, number, half.spheres.x, 1.0 - half.at, side);
        couple_sphere(k, number, half.spheres.y, half.at, side);
        return;
    }
    couple_sphere(k, number, half.spheres.x, 1.0, side);
}

// Puts down all of a collision that is left to sweeps.
fn couple(k: Record, number: u32, is_only: bool) {
    begin_couplings();
    couple_side(k, number, half_of(k.a_id, k.a), 1.0);
    couple_side(k, number, half_of(k.b_id, k.b), -1.0);
    put_couplings(number, is_only);
}
