// requires model/objects.wgsl model/order.wgsl model/step.wgsl

// Where the springs of contacts are kept (docs/physics section 4.11). A block of `histories` has HISTORY_BLOCK records of
// two vectors: displacement and overlap; moment and the key of the other object. Each mover has a block, by insertion index. A
// mover that owns more contacts has a chain of blocks, which continues in blocks of the pool. The last record of a block that
// does not end the chain is a link: the bit LINK_KEY and the number of the next block. A record without a key ends the chain,
// and so does the end of a block. There are two tables of blocks: the springs before the step, and those after it.

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

// Number of blocks of a table.
fn table_blocks() -> u32 {
    return step.spheres + step.rods + step.history_pool;
}

// First vector of a table: 0 is the one with the springs before the step, 1 that with those after it.
fn first_vector(table: u32) -> u32 {
    return (status.history_table ^ table) * 2u * HISTORY_BLOCK * table_blocks();
}

// First record of a mover in a table.
fn first_record(mover: u32) -> u32 {
    return HISTORY_BLOCK * insertion_index(mover);
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

// A record of the table before the step, or the one that a link in its place leads to. NONE at the end of the chain.
fn followed(record: u32) -> u32 {
    let last = histories[first_vector(0u) + 2u * record + 1u].w;
    if last == NO_KEY {
        return NONE;
    }
    return select(record, HISTORY_BLOCK * (last & ~LINK_KEY), (last & LINK_KEY) != 0u);
}

// The record after a record, or NONE.
fn record_after(record: u32) -> u32 {
    if (record + 1u) % HISTORY_BLOCK == 0u {
        return NONE;
    }
    return followed(record + 1u);
}

fn key_of_record(record: u32) -> u32 {
    return histories[first_vector(0u) + 2u * record + 1u].w;
}

fn spring_of_record(record: u32) -> Spring {
    let at = first_vector(0u) + 2u * record;
    let words = bitcast<vec4f>(histories[at]);
    return Spring(words.xyz, words.w, bitcast<vec3f>(histories[at + 1u].xyz));
}

fn no_spring() -> Spring {
    return Spring(vec3f(0.0), 0.0, vec3f(0.0));
}

// The spring of the contact of a and b before the step.
fn spring_of(a: u32, b: u32, feature: u32) -> Spring {
    let is_first = first_owns(a, b);
    let key = entry_key(select(a, b, is_first), feature);
    var record = followed(first_record(select(b, a, is_first)));
    while record != NONE {
        if key_of_record(record) == key {
            return spring_of_record(record);
        }
        record = record_after(record);
    }
    return no_spring();
}

// The chain of a mover in the table after the step: its first record, and the record after the last one.
struct Chain {
    first: u32,
    end: u32,
}

fn new_chain(mover: u32) -> Chain {
    let first = first_record(mover);
    return Chain(first, first);
}

// Whether the last block of a chain has no free record.
fn is_full(chain: Chain) -> bool {
    return (chain.end % HISTORY_BLOCK == 0u) & (chain.end != chain.first);
}

// Takes a block of the pool for a chain whose last block is full. A link takes the place of the last record, which moves to the new
// block. Returns the next free record. If the pool has no room, the step is rejected, and blocks are only counted.
fn lengthen(end: u32) -> u32 {
    let block = step.spheres + step.rods + atomicAdd(&status.history_blocks, 1u);
    if block < table_blocks() {
        let old = first_vector(1u) + 2u * (end - 1u);
        let new_ = first_vector(1u) + 2u * HISTORY_BLOCK * block;
        histories[new_] = histories[old];
        histories[new_ + 1u] = histories[old + 1u];
        histories[old + 1u] = vec4u(LINK_KEY | block);
    } else {
        atomicOr(&status.rejected, REJECTED_HISTORY);
    }
    return HISTORY_BLOCK * block + 1u;
}

// Whether a record is in the table, and not in a block for which the pool has no room.
fn is_in_table(record: u32) -> bool {
    return record < HISTORY_BLOCK * table_blocks();
}

// Appends a spring after the step.
fn put_spring(key: u32, spring: Spring, chain: ptr<function, Chain>) {
    if is_full(*chain) {
        (*chain).end = lengthen((*chain).end);
    }
    let record = (*chain).end;
    if is_in_table(record) {
        let at = first_vector(1u) + 2u * record;
        histories[at] = bitcast<vec4u>(vec4f(spring.shift, spring.overlap));
        histories[at + 1u] = vec4u(bitcast<vec3u>(spring.moment), key);
    }
    (*chain).end = record + 1u;
}

fn end_chain(chain: Chain) {
    if !is_full(chain) & is_in_table(chain.end) {
        histories[first_vector(1u) + 2u * chain.end + 1u] = vec4u(NO_KEY);
    }
}
