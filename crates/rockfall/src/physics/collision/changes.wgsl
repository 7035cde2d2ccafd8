// requires model/collision_state.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl
// requires physics/contact.wgsl physics/escape.wgsl physics/motion.wgsl step/collisions/rows.wgsl

// The state of a single sphere after its collisions.

// The changes of a sphere, divided by its inverse mass.
struct Change {
    velocity: vec3f,
    position: vec3f,
}

// What a collision adds to the `Change` of a sphere: its normal times `velocity`, and its normal times `position`.
struct Part {
    n: vec3f,
    velocity: f32,
    position: f32,
}

// Each addition is an explicit `fma`, so that the sums of all kernels are bitwise identical.
fn add_part(part: Part, change: ptr<function, Change>) {
    (*change).velocity = fma(part.n, vec3f(part.velocity), (*change).velocity);
    (*change).position = fma(part.n, vec3f(part.position), (*change).position);
}

fn no_part() -> Part {
    return Part(vec3f(0.0), 0.0, 0.0);
}

// Adds the colliding entries of a row.
fn add_row(sphere: u32, row: u32, change: ptr<function, Change>) {
    if !has_collisions(row) {
        return;
    }
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_COLLIDES, first, begin, count); rest != 0u; rest &= rest - 1u) {
            add_part(part_of_entry(sphere, row, slot_at(first, begin + firstTrailingBit(rest))), change);
        }
    }
}

// The changes of a single sphere by all its collisions.
fn changes_of(sphere: u32) -> Change {
    var change = Change(vec3f(0.0), vec3f(0.0));
    add_row(sphere, sphere, &change);
    if RODS {
        let rods = rods_of(sphere);
        for (var r = 0u; r < rods.y; r++) {
            add_row(sphere, step.spheres + index_of(topology[rods.x + r]), &change);
        }
    }
    return change;
}

// Writes the state of a sphere after its collisions.
fn write_changed(i: u32, change: Change) {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = Motion(old_position.xyz, low_row(i), old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        after.velocity += old_velocity.w * change.velocity;
        after = displaced(after, old_velocity.w * change.position);
    }
    write_motion(i, after);
}

fn write_motion(i: u32, wanted: Motion) {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = wanted;
    if (old_velocity.w > 0.0) & !is_finite(after) {
        after = stopped(old_position.xyz, low_row(i), 0u, i);
    }
    let position = vec4f(after.position, old_position.w);
    let velocity = vec4f(after.velocity, old_velocity.w);
    request_rebuild(i, position, velocity);
    put_next(0u, i, position);
    put_next(1u, i, own_velocity_after(i, velocity));
    if HALF_STEP {
        put_next(4u, i, velocity);
    }
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
    put_next(3u, i, vec4f(after.low, 0.0));
}
