// requires model/counters.wgsl model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl
// requires physics/contact.wgsl physics/forces/attached.wgsl physics/geometry.wgsl

// Net force and torque on a sphere (docs/physics.md section 4), and the counts of its contacts.

struct Net {
    // Forces of contacts and attachments, without body forces.
    force: vec3f,
    torque: vec3f,
    // Number of contacts with objects of higher insertion index. Counted in pass COUNTED only.
    contacts: u32,
    // Deepest overlap of these contacts.
    deepest: f32,
}

// The force evaluation that counts contacts: the first one, or that at the end of a step of velocity Verlet.
const COUNTED: u32 = 3u * u32(VERLET);

// Effect of a contact on a sphere.
struct Push {
    force: vec3f,
    // Torque per unit length of the arm.
    torque_per_arm: vec3f,
    arm: f32,
    // 0 when the objects are apart.
    overlap: f32,
}

fn no_push() -> Push {
    return Push(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
}

fn add_contacts(i: u32, net: ptr<function, Net>) {
    let count = count_of(i);
    if count == 0u {
        return;
    }
    let own = state[position_at(i)];
    let side = sphere_side(own, state[velocity_at(i)], state[momentum_at(i)]);
    let first = first_of(i);
    let partner = bonded_partner(i);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        // Pairs that overlapped at the start of the step most likely still do. For other pairs of spheres that do not touch,
        // only one position is read.
        var rest = entries_near(own, ENTRY_OVERLAPS, first, begin, count);
        if RODS {
            rest = without_distant_rods(i, own, ENTRY_OVERLAPS, first, begin, count, rest);
        }
        var now = meet(first, begin, rest);
        while rest != 0u {
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            let push = push_of(i, partner, own, side, now);
            // An explicit fma, so that the sums of one thread and those of a workgroup are bitwise identical.
            (*net).force += push.force;
            (*net).torque = fma(push.torque_per_arm, vec3f(push.arm), (*net).torque);
            count_push(i, now.entry, push, net);
            now = ahead;
        }
    }
}

// Contact of a sphere with the object of an entry. The sphere is evaluated as A. The other object has a higher id or is also a
// sphere. Between spheres the contact law is symmetric, except for rounding errors of the slip.
fn push_of(i: u32, partner: u32, own: vec4f, side: Side, other: LoadedEntry) -> Push {
    let id = entry_id(other.entry);
    var found = no_touch();
    var their_side = sphere_side(other.place, other.velocity, other.momentum);
    if id < step.spheres {
        found = touch_two(i, own, id, other.place);
        if joined(i, partner, id) {
            return no_push();
        }
    } else {
        found = touch_static_or_rod(i, id, own);
        their_side = other_side(id, found.b);
    }
    // A position far outside of the range of f32 makes the overlap no number. That is no contact either.
    if !(found.overlap > 0.0) | (side.inverse_mass + their_side.inverse_mass <= 0.0) {
        return no_push();
    }
    let contact = contact_force(side, their_side, found, i, id);
    return Push(contact.force, contact.torque_per_arm, contact.arm_a, found.overlap);
}

// Counts a contact, only in the pass that counts and only on the side that was added first.
fn count_push(i: u32, entry: u32, push: Push, net: ptr<function, Net>) {
    if (evaluation() != COUNTED) | (push.overlap <= 0.0) {
        return;
    }
    if insertion_index(i) < insertion_index(entry_id(entry)) {
        (*net).contacts += 1u;
        (*net).deepest = max((*net).deepest, push.overlap);
    }
}

fn add_attachments(i: u32, net: ptr<function, Net>) {
    let range = adjacency(i);
    for (var at = range.x; at < range.y; at++) {
        let kind = kind_of(topology[at]);
        let index = index_of(topology[at]);
        if RODS & (kind == KIND_ROD) {
            add_wrench(i, index, net);
        } else {
            (*net).force += attached_force(i, kind, index);
        }
    }
}

fn no_force() -> Net {
    return Net(vec3f(0.0), vec3f(0.0), 0u, 0.0);
}

fn net_force(i: u32) -> Net {
    var net = no_force();
    if LAW == LAW_THESIS {
        add_contacts(i, &net);
    } else {
        add_law_load(i, &net);
    }
    add_attachments(i, &net);
    return net;
}

// Net force on a sphere in a pass. For a fixed sphere it is only evaluated in the pass that counts contacts.
fn net_in_pass(i: u32) -> Net {
    if (evaluation() == COUNTED) | (inverse_mass(i) > 0.0) {
        return net_force(i);
    }
    return no_force();
}

var<workgroup> group_deepest: atomic<u32>;

// Adds the contacts of a workgroup to the counters. All its threads must call it. Positive floats are ordered as their bits
// are.
fn count_contacts_of_workgroup(workgroup: u32, local: u32, contacts: u32, deepest: f32) {
    if local == 0u {
        atomicStore(&group_count, 0u);
        atomicStore(&group_deepest, 0u);
    }
    workgroupBarrier();
    if contacts > 0u {
        atomicAdd(&group_count, contacts);
        atomicMax(&group_deepest, bitcast<u32>(deepest));
    }
    workgroupBarrier();
    if local == 0u {
        let sum = atomicLoad(&group_count);
        if sum > 0u {
            let counter_block = workgroup % COUNTER_BLOCKS;
            atomicAdd(&status.counters[counter_block].contacts, sum);
            atomicMax(&status.counters[counter_block].max_overlap, atomicLoad(&group_deepest));
        }
    }
}
