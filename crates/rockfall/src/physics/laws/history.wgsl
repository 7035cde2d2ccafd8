// requires model/objects.wgsl model/order.wgsl model/step.wgsl

// Where the springs of contacts are kept (docs/physics.md section 4.11). A row of `histories` belongs to a mover, by insertion
// index. It has `history_room` records of two vectors: displacement and overlap; moment and the key of the other
// object. A record without a key ends the row. There are two tables of rows: the springs before the step, and those after it.

struct Spring {
    shift: vec3f,
    // Not positive for a new contact.
    overlap: f32,
    // Moment on A of the springs against rolling and twisting.
    moment: vec3f,
}

// Whether the evaluation advances the springs. The one at the start of a step of velocity Verlet repeats that at the end of the
// step before, which has advanced them.
fn advances_springs() -> bool {
    return !VERLET | (evaluation() != 0u);
}

// The time by which the evaluation advances the springs.
fn spring_time() -> f32 {
    return select(0.0, step.dt, advances_springs());
}

fn record_of_row(row: u32, place: u32) -> u32 {
    return 2u * (row * step.history_room + place);
}

// First row of a table: 0 is the one with the springs before the step, 1 that with those after it.
fn first_row(table: u32) -> u32 {
    return (status.history_table ^ table) * (step.spheres + step.rods);
}

// Whether the mover a owns its contact with object b; a was added first. Of two spheres or two rods, the smaller one does. Of two
// equal ones it is a if both insertion indices are even or both are odd, so that nobody owns all of its contacts. A sphere owns its
// contacts with rods.
fn first_owns(a: u32, b: u32) -> bool {
    var radii = vec2f(0.0);
    if b < step.spheres {
        radii = vec2f(state[position_at(a)].w, state[position_at(b)].w);
    } else if RODS & (a >= step.spheres) & (b < step.spheres + step.rods) {
        radii = vec2f(rod_radius(a - step.spheres), rod_radius(b - step.spheres));
    } else {
        return true;
    }
    if radii.x == radii.y {
        return ((insertion_index(a) ^ insertion_index(b)) & 1u) == 0u;
    }
    return radii.y > radii.x;
}

// The spring of the contact of a and b before the step.
fn spring_of(a: u32, b: u32, feature: u32) -> Spring {
    let is_first = first_owns(a, b);
    let row = first_row(0u) + insertion_index(select(b, a, is_first));
    let key = entry_key(select(a, b, is_first), feature);
    for (var place = 0u; place < step.history_room; place++) {
        let at = record_of_row(row, place);
        let last = histories[at + 1u];
        if last.w == key {
            let words = bitcast<vec4f>(histories[at]);
            return Spring(words.xyz, words.w, bitcast<vec3f>(last.xyz));
        }
        if last.w == NO_KEY {
            break;
        }
    }
    return Spring(vec3f(0.0), 0.0, vec3f(0.0));
}

// Writes a record of the springs after the step.
fn put_spring(mover: u32, place: u32, key: u32, spring: Spring) {
    let at = record_of_row(first_row(1u) + insertion_index(mover), place);
    histories[at] = bitcast<vec4u>(vec4f(spring.shift, spring.overlap));
    histories[at + 1u] = vec4u(bitcast<vec3u>(spring.moment), key);
}

// Ends the row of a mover after `count` records.
fn end_row(mover: u32, count: u32) {
    if count < step.history_room {
        histories[record_of_row(first_row(1u) + insertion_index(mover), count) + 1u] = vec4u(NO_KEY);
    }
}
