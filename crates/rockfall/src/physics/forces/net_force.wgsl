// requires model/counters.wgsl model/entries.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl
// requires

// Net force and torque on a sphere (docs/physics section 4), and the counts of its contacts.

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

// Whether this process counts the contact of sphere a, which was added first, with object b. Of several processes, that one does
// which owns the first of their moving spheres.
fn is_counted_here(a: u32, b: u32) -> bool {
    if step.own_at == 0u {
        return true;
    }
    var first = a;
    if (b < step.spheres) & (inverse_mass(a) == 0.0) {
        first = select(a, b, inverse_mass(b) > 0.0);
    }
    let index = insertion_index(first);
    return ((topology[step.own_at + index / 32u] >> (index % 32u)) & 1u) != 0u;
}

// Counts the contact of sphere i with an entry of its list, only in the pass that counts and only on the side that was added first.
fn count_push(i: u32, entry: u32, push: Push, net: ptr<function, Net>) {
    if (evaluation() == COUNTED) & (push.overlap > 0.0) {
        count_if(insertion_index(i) < insertion_index(entry_id(entry)), i, entry, push, net);
    }
}

fn count_if(is_first: bool, i: u32, entry: u32, push: Push, net: ptr<function, Net>) {
    if is_first {
        if is_counted_here(i, entry_id(entry)) {
            (*net).contacts += 1u;
            (*net).deepest = max((*net).deepest, push.overlap);
        }
    }
}

fn no_force() -> Net {
    return Net(vec3f(0.0), vec3f(0.0), 0u, 0.0);
}

var<workgroup> group_deepest: atomic<u32>;

// Begins the count of a workgroup, before any loop.
fn begin_contacts(local: u32) {
    if local == 0u {
        atomicStore(&group_deepest, 0u);
    }
    begin_count(local);
}

// Adds the contacts of a workgroup to the counters. All its threads must call it. Positive floats are ordered as their bits
// are.
fn count_contacts_of_workgroup(workgroup: u32, contacts: u32, deepest: f32) {
    if contacts > 0u {
        atomicMax(&group_deepest, bitcast<u32>(deepest));
    }
    let sum = add_to_count(contacts);
    if (sum != NOT_LAST) & (sum > 0u) {
        let counter_block = workgroup % COUNTER_BLOCKS;
        atomicAdd(&status.counters[counter_block].contacts, sum);
        atomicMax(&status.counters[counter_block].max_overlap, atomicLoad(&group_deepest));
    }
}
