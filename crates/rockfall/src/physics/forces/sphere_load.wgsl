// requires physics/forces/sphere_push.wgsl model/early.wgsl model/entries.wgsl model/lists.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/attached.wgsl physics/forces/net_force.wgsl physics/geometry.wgsl physics/surfaces_of_list.wgsl physics/laws/history.wgsl physics/laws/mover_contact.wgsl

// The load of a sphere, computed by one thread.

// An explicit fma, so that the sums of one thread and those of a workgroup are bitwise identical.
fn add_push(push: Push, net: ptr<function, Net>) {
    (*net).force += push.force;
    (*net).torque = fma(push.torque_per_arm, vec3f(push.arm), (*net).torque);
}

// Contacts by the law of the thesis.
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
        rest &= ~hidden_entries(i, own, first, begin, count);
        var now = meet(first, begin, rest);
        while rest != 0u {
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            let push = push_of(i, partner, own, side, now);
            add_push(push, net);
            count_push(i, now.entry, push, net);
            now = ahead;
        }
    }
}

// Contacts by a law with history. An early pass leaves their springs to the pass that computes all spheres.
fn add_law_contacts(i: u32, net: ptr<function, Net>) {
    var chain = new_chain(i);
    let own = state[position_at(i)];
    let count = count_of(i);
    let first = first_of(i);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        // Necks connect spheres that are apart.
        var rest = 0xffffffffu >> (32u - min(ENTRIES_PER_MASK, count - begin));
        if !COHESION {
            rest = entries_near(own, 0u, first, begin, count);
        }
        rest &= ~hidden_entries(i, own, first, begin, count);
        for (; rest != 0u; rest &= rest - 1u) {
            let entry = entry_at(slot_at(first, begin + firstTrailingBit(rest)));
            let met = mover_contact(i, entry);
            if !met.touches {
                continue;
            }
            add_push(met.push, net);
            count_if(met.is_a, i, entry, met.push, net);
            if met.owns & !is_early() {
                put_spring(entry_key(entry_id(entry), entry_feature(entry)), met.spring, &chain);
            }
        }
    }
    if advances_springs() & !is_early() {
        end_chain(chain);
    }
}

fn add_attachments(i: u32, net: ptr<function, Net>) {
    let range = adjacency(i);
    for (var at = range.x; at < range.y; at++) {
        let kind = kind_of(topology[at]);
        let index = index_of(topology[at]);
        if RODS & (kind == KIND_ROD) {
            let end = 4u * index + select(2u, 0u, rod_ends(index).x == i);
            (*net).force += wrenches[end].xyz;
            (*net).torque += wrenches[end + 1u].xyz;
        } else {
            (*net).force += attached_force(i, kind, index);
        }
    }
}

// The load of a sphere. That of a fixed sphere is not needed, but its contacts are counted, and it may own springs.
fn sphere_load(i: u32) -> Net {
    var net = no_force();
    if LAW != LAW_THESIS {
        add_law_contacts(i, &net);
    } else if (evaluation() == COUNTED) | (inverse_mass(i) > 0.0) {
        add_contacts(i, &net);
    }
    add_attachments(i, &net);
    return net;
}
