// requires model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/contact.wgsl
// requires step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl

// The changes of the velocities of bodies by the impulses in the records (docs/physics section 3.7).

// Adds the impulses on a sphere by the collisions of a row. If the row is a rod, the sphere gets the share of its end.
fn add_impulses(sphere: u32, row: u32, sweeps: u32, sum: ptr<function, vec3f>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let part = impulse_after(r, sweeps) * part_on(sphere, row, r);
            *sum = fma(impulse_normal(r), vec3f(part), *sum);
        }
    }
}

// The share, with its sign, of the impulse of record r along n that a sphere gets through a row. The row is the sphere
// itself or a rod that ends in it.
fn part_on(sphere: u32, row: u32, r: u32) -> f32 {
    let k = record_at(r);
    let is_a = k.a_id == row;
    let sign = select(1.0, -1.0, is_a);
    if !RODS | (row < step.spheres) {
        return sign;
    }
    let at = select(k.b, k.a, is_a);
    return sign * select(at, 1.0 - at, rod_ends(row - step.spheres).x == sphere);
}

// The sum of the impulses on a single sphere. For a sphere of a network, it is the sum before the projection.
fn impulses_on(sphere: u32, sweeps: u32) -> vec3f {
    var sum = vec3f(0.0);
    add_impulses(sphere, sphere, sweeps, &sum);
    if RODS {
        let rods = rods_of(sphere);
        for (var r = 0u; r < rods.y; r++) {
            add_impulses(sphere, step.spheres + index_of(topology[rods.x + r]), sweeps, &sum);
        }
    }
    return sum;
}

// Changes of the velocity and of the spin of a rigid capsule.
struct CapsuleChange {
    velocity: vec3f,
    spin: vec3f,
}

// Adds the impulses and the torques on a capsule by the collisions of a row.
fn add_kicks(capsule: Capsule, rod: u32, row: u32, sweeps: u32, kick: ptr<function, CapsuleChange>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let k = record_at(r);
            let is_a = k.a_id == row;
            let at = at_on_capsule(rod, row, select(k.b, k.a, is_a));
            let n = impulse_normal(r);
            let impulse = select(1.0, -1.0, is_a) * impulse_after(r, sweeps);
            (*kick).velocity = fma(n, vec3f(impulse), (*kick).velocity);
            (*kick).spin = fma(torque_at(capsule, at, n), vec3f(impulse), (*kick).spin);
        }
    }
}

fn capsule_change(capsule: Capsule, rod: u32, sweeps: u32) -> CapsuleChange {
    var kick = CapsuleChange(vec3f(0.0), vec3f(0.0));
    let ends = rod_ends(rod);
    add_kicks(capsule, rod, ends.x, sweeps, &kick);
    add_kicks(capsule, rod, ends.y, sweeps, &kick);
    add_kicks(capsule, rod, step.spheres + rod, sweeps, &kick);
    return CapsuleChange(capsule.inverse_mass * kick.velocity, capsule.inverse_inertia * kick.spin);
}
