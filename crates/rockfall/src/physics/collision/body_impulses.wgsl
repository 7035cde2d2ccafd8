// requires model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl physics/rigid.wgsl
// requires physics/rigid_lever.wgsl
// requires step/collisions/record_of.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl

// The impulses on rigid bodies by the collisions in the records (docs/physics section 3.11). Those of lone collisions act at another place.

// The sum of the impulses on a rigid body, and that of their torques about its centre of mass.
struct BodyKick {
    impulse: vec3f,
    torque: vec3f,
    // The row and the record of the last collision, NONE without one.
    row: u32,
    number: u32,
}

// The parameter of record r on a row.
fn at_on_row(k: Record, row: u32) -> f32 {
    return select(k.b, k.a, k.a_id == row);
}

// The lever of record k on a body, at a row of it.
fn lever_of_record(record: u32, row: u32, k: Record) -> vec3f {
    return lever_on_body(record, row, at_on_row(k, row));
}

fn add_to_body(record: u32, row: u32, sweeps: u32, kick: ptr<function, BodyKick>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let r = record_of(slot_at(first, begin + firstTrailingBit(rest)));
            let k = record_at(r);
            (*kick).row = row;
            (*kick).number = r;
            let impulse = select(1.0, -1.0, k.a_id == row) * impulse_after(r, sweeps);
            (*kick).impulse = fma(k.n, vec3f(impulse), (*kick).impulse);
            (*kick).torque = fma(cross(lever_of_record(record, row, k), k.n), vec3f(impulse), (*kick).torque);
        }
    }
}

// Adds the impulses in the rows of a sphere of the body.
fn add_rows_of_member(body: u32, record: u32, sphere: u32, sweeps: u32, kick: ptr<function, BodyKick>) {
    let rods = rods_of(sphere);
    for (var r = 0u; r <= rods.y; r++) {
        let row = row_of_member(body, sphere, rods, r);
        if row != NONE {
            add_to_body(record, row, sweeps, kick);
        }
    }
}

fn no_kick() -> BodyKick {
    return BodyKick(vec3f(0.0), vec3f(0.0), NONE, NONE);
}

fn body_kick(body: u32, sweeps: u32) -> BodyKick {
    let record = rigid_record(body);
    var kick = no_kick();
    for (var member = 0u; member < topology[record + 13u]; member++) {
        add_rows_of_member(body, record, id_of(topology[topology[record + 12u] + member]), sweeps, &kick);
    }
    return kick;
}
