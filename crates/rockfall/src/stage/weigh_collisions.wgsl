@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> words: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> row_sums: array<array<f32, SLICE>>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

// So many collisions are weighed at once, and so many coupled contacts worked out between two barriers, shared out evenly among them.
// Both are small: what takes time is that one load waits for another, so as many workgroups as may be should find room beside each
// other, which workgroup memory bounds.
const AT_ONCE: u32 = 16u;
const ROOM: u32 = 128u;

// So many collisions are put down at once: without rods they take little room.
const QUEUE: u32 = select(256u, AT_ONCE, RODS);

// The collisions at hand: which mover has it, and where in its list; ids and feature.
var<workgroup> places: array<vec2u, QUEUE>;
var<workgroup> names: array<vec3u, AT_ONCE>;
var<workgroup> collisions: array<Contact, AT_ONCE>;
// How many coupled contacts each has put down.
var<workgroup> gathered: array<u32, WORKGROUP>;
// Slot in the collision << SLOT_SHIFT | row, and the entry in that row; the bits of the term take the place of the first.
var<workgroup> coupled: array<vec2u, ROOM>;
var<workgroup> count_up: atomic<u32>;
// What all threads are to know.
var<workgroup> told_to_all: u32;

const SLOT_SHIFT: u32 = 30u;

// Up to where the coupled contacts of a collision were gathered: slot, number of the row, entry. The slots are 4.
struct Task {
    slot: u32,
    row: u32,
    next: u32,
    sums: RowSums,
}

// The first entry from `begin` on that has one of these bits; `count`: there is none.
fn next_with(bits: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    for (var e = begin; e < count; e += 4u) {
        let marked = which((four_entries(first, e, count) & vec4u(bits)) != vec4u(0u), e, count);
        if marked != 0u {
            return e + firstTrailingBit(marked);
        }
    }
    return count;
}

// The slot of a mover in the list of another, which is in order; of row NONE: it is not there.
fn slot_in(row: u32, mover: u32) -> vec2u {
    let key = entry_key(mover, 0u);
    let first = first_of(row);
    var low = 0u;
    var high = count_of(row);
    while low < high {
        let middle = (low + high) / 2u;
        let entry = entry_at(slot_at(first, middle));
        if entry_id(entry) == mover {
            return slot_at(first, middle);
        }
        if entry_key(entry_id(entry), 0u) < key {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return vec2u(NONE);
}

// A body that has a long list may have many collisions: so of two movers the one with the shorter list weighs theirs. But those of a
// large sphere are left to its team.
fn is_own(mover: u32, id: u32) -> bool {
    if id >= step.spheres + step.rods {
        return true;
    }
    if !RODS & is_large(id) {
        return false;
    }
    let own = count_of(mover);
    let other = count_of(id);
    return (own < other) | ((own == other) & (user_of(mover) < user_of(id)));
}

// Stores a row sum with the entries of both sides.
fn put_sum(mover: u32, slot: vec2u, row_sum: f32) {
    row_sums[row_of_sums(slot)][slot.y] = row_sum;
    let id = entry_id(entry_at(slot));
    if id < step.spheres + step.rods {
        let other = slot_in(id, mover);
        if other.x != NONE {
            row_sums[row_of_sums(other)][other.y] = row_sum;
        }
    }
}

// The next collision, from an entry on, that is this mover's to weigh. The length of the list: there is none.
fn next_own(mover: u32, begin: u32) -> u32 {
    let count = count_of(mover);
    let first = first_of(mover);
    for (var e = begin; ; e++) {
        e = next_with(ENTRY_COLLIDES, first, e, count);
        if e >= count {
            break;
        }
        if is_own(mover, entry_id(entry_at(slot_at(first, e)))) {
            return e;
        }
    }
    return count;
}

// Weighs the collision of this entry, if it is a plain one among plain ones.
fn weighs_plain(mover: u32, e: u32) -> bool {
    let slot = slot_of(mover, e);
    let pair = ordered(mover, entry_id(entry_at(slot)));
    if !are_plain(pair.x, pair.y) {
        return false;
    }
    let row_sum = plain_row_sum(pair.x, pair.y);
    if row_sum == 0.0 {
        return false;
    }
    put_sum(mover, slot, row_sum);
    return true;
}

// The next of them, from an entry on, that is no plain one among plain ones: those are weighed on the way.
fn next_collision(mover: u32, begin: u32) -> u32 {
    let count = count_of(mover);
    var e = next_own(mover, begin);
    while e < count {
        if !weighs_plain(mover, e) {
            break;
        }
        e = next_own(mover, e + 1u);
    }
    return e;
}

fn next_to_put_down(mover: u32, begin: u32) -> u32 {
    if RODS {
        return next_collision(mover, begin);
    }
    return next_own(mover, begin);
}

// False where there is no room for it.
fn put_down_one(mover: u32, e: u32) -> bool {
    let place = atomicAdd(&count_up, 1u);
    if place < QUEUE {
        places[place] = vec2u(mover, e);
    }
    return place < QUEUE;
}

// Puts down a mover's collisions from an entry on, as many as there is room for; gives the entry to go on from.
fn put_down(mover: u32, begin: u32) -> u32 {
    let count = count_of(mover);
    var e = next_to_put_down(mover, begin);
    while e < count {
        if !put_down_one(mover, e) {
            break;
        }
        e = next_to_put_down(mover, e + 1u);
    }
    return e;
}

// Works out the contact of a collision that was put down.
fn take_up(local: u32, mover: u32, e: u32) {
    let entry = entry_at(slot_of(mover, e));
    let name = vec3u(ordered(mover, entry_id(entry)), entry_feature(entry));
    names[local] = name;
    collisions[local] = contact_of(name.x, name.y, touch(name.x, name.y, name.z));
}

// Whether the contacts of the sphere in a slot couple with the collision and are not all those of the slot before: the two ends of
// a capsule have the same rows. What cannot move couples nothing.
fn couples(local: u32, slot: u32) -> bool {
    let sphere = collisions[local].spheres[slot];
    if (sphere == NONE) | (collisions[local].inverse_masses[slot] <= 0.0) {
        return false;
    }
    if (slot & 1u) == 0u {
        return true;
    }
    let before = collisions[local].spheres[slot - 1u];
    if collisions[local].inverse_masses[slot - 1u] <= 0.0 {
        return true;
    }
    return (capsule_partner(sphere) != before) | (capsule_partner(before) != sphere);
}

// Puts down the next contacts that may be coupled with a collision, as many as there is room for; gives their number.
fn gather(local: u32, task: ptr<function, Task>, at: u32, room: u32) -> u32 {
    var count = 0u;
    for (; (*task).slot < 4u; (*task).slot++) {
        if couples(local, (*task).slot) {
            let sphere = collisions[local].spheres[(*task).slot];
            let rods = rods_of(sphere);
            for (; (*task).row < 1u + 2u * rods.y; (*task).row++) {
                let row = row_of(sphere, rods, (*task).row);
                if row != NONE {
                    let length = count_of(row);
                    let first = first_of(row);
                    loop {
                        let e = next_with(ENTRY_OVERLAPS, first, (*task).next, length);
                        if e >= length {
                            break;
                        }
                        if count == room {
                            return count;
                        }
                        coupled[at + count] = vec2u((*task).slot << SLOT_SHIFT | row, entry_at(slot_at(first, e)));
                        count += 1u;
                        (*task).next = e + 1u;
                    }
                }
                (*task).next = 0u;
            }
        }
        (*task).row = 0u;
    }
    return count;
}

// Works out what was gathered for all collisions, by all threads: neighbours take one of each collision in turn. All have as many
// rounds, for a barrier follows (see run_steps.wgsl).
fn work_out(local: u32, owned: u32, room: u32) {
    for (var first = 0u; first < owned * room; first += WORKGROUP) {
        let turn = first + local;
        let owner = turn % owned;
        if (turn < owned * room) & (turn / owned < gathered[owner]) {
            let at = owner * room + turn / owned;
            let what = coupled[at];
            var k = collisions[owner];
            let row = what.x & ((1u << SLOT_SHIFT) - 1u);
            coupled[at].x = bitcast<u32>(coupled_term(&k, names[owner], what.x >> SLOT_SHIFT, row, what.y));
        }
    }
}

// Adds up what was worked out for one collision, in its order.
fn add_terms(at: u32, count: u32, task: ptr<function, Task>) {
    for (var c = at; c < at + count; c++) {
        let term = bitcast<f32>(coupled[c].x);
        (*task).sums.overlapping += term;
        if (coupled[c].y & ENTRY_COLLIDES) != 0u {
            (*task).sums.colliding += term;
        }
    }
}

// What `count_up` has come to, up to so many; it is 0 then. All threads of the workgroup must come here.
fn counted_up(local: u32, most: u32) -> u32 {
    workgroupBarrier();
    if local == 0u {
        told_to_all = min(atomicLoad(&count_up), most);
        atomicStore(&count_up, 0u);
    }
    return workgroupUniformLoad(&told_to_all);
}

// Weighs the collisions at hand. All threads of the workgroup must come here, and get the same.
fn weigh_all(local: u32, owned: u32) {
    let room = ROOM / owned;
    let mover = places[local % owned].x;
    let e = places[local % owned].y;
    var task = Task(4u, 0u, 0u, RowSums(0.0, 0.0));
    if local < owned {
        take_up(local, mover, e);
        task.slot = 0u;
    }
    loop {
        gathered[local] = gather(local, &task, local * room, room);
        workgroupBarrier();
        work_out(local, owned, room);
        workgroupBarrier();
        add_terms(local * room, gathered[local], &task);
        if task.slot < 4u {
            atomicAdd(&count_up, 1u);
        }
        if counted_up(local, WORKGROUP) == 0u {
            break;
        }
    }
    if local < owned {
        put_sum(mover, slot_of(mover, e), signed_sum(task.sums));
    }
}

// What takes long is that one load waits for another, tens of them for each coupled contact. So a collision is weighed by one thread,
// whosever it is, and its coupled contacts are worked out by all of them side by side.
@compute @workgroup_size(64)
fn weigh_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if local == 0u {
        told_to_all = u32(has_changes());
        atomicStore(&count_up, 0u);
    }
    if workgroupUniformLoad(&told_to_all) == 0u {
        return;
    }
    let workgroup = linear_group(group, groups);
    // Among rods large spheres have no teams here.
    var mover = workgroup * WORKGROUP + local;
    if !RODS {
        if is_team(workgroup) {
            weigh_together(sphere_of_team(workgroup), local);
            return;
        }
        mover = mover_of(workgroup, local);
    }
    var works = false;
    if mover < step.spheres + step.rods {
        works = has_collisions(mover);
    }
    var next = 0u;
    loop {
        if works {
            next = put_down(mover, next);
            works = next < count_of(mover);
        }
        let owned = counted_up(local, QUEUE);
        if owned == 0u {
            break;
        }
        if RODS {
            weigh_all(local, owned);
        } else {
            weigh_plain(local, owned);
        }
    }
}
