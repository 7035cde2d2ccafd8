// requires physics/forces/sphere_push.wgsl physics/surfaces_of_list.wgsl model/early.wgsl model/entries.wgsl model/lists.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/net_force.wgsl physics/forces/sphere_load.wgsl physics/geometry.wgsl physics/laws/history.wgsl
// requires physics/laws/mover_contact.wgsl step/large_spheres/ordered_sums.wgsl step/large_spheres/workgroup_per_sphere.wgsl

// Loads of large spheres, with a workgroup per sphere. The threads compute one contact each, and the forces are added in the order of
// the list.

// The keys and springs that the threads of a workgroup append. A key is NO_KEY if its thread has none.
var<workgroup> new_keys: array<u32, SPRINGS>;
var<workgroup> new_springs: array<Spring, SPRINGS>;
const SPRINGS: u32 = select(LARGE_WORKGROUP, 1u, LAW == LAW_THESIS);

// Appends the springs of the threads in their order. The other threads run the same loop, because all threads should make the same
// number of rounds before a barrier (see sweep_at_once.wgsl).
fn put_springs_in_order(local: u32, count: u32, chain: ptr<function, Chain>) {
    for (var k = 0u; k < count; k++) {
        if (local == 0u) & (new_keys[k] != NO_KEY) {
            put_spring(new_keys[k], new_springs[k], chain);
        }
    }
}

// The effect of one contact on a large sphere. Counts it, and notes its spring.
fn large_push(i: u32, local: u32, partner: u32, own: vec4f, side: Side, entry: u32, net: ptr<function, Net>) -> Push {
    if LAW == LAW_THESIS {
        let push = push_of(i, partner, own, side, load_entry(entry, true));
        count_push(i, entry, push, net);
        return push;
    }
    let met = mover_contact(i, entry);
    count_if(met.is_a, i, entry, met.push, net);
    if met.owns {
        new_keys[local] = entry_key(entry_id(entry), entry_feature(entry));
        new_springs[local] = met.spring;
    }
    return met.push;
}

fn add_contacts_by_workgroup(i: u32, local: u32, net: ptr<function, Net>) {
    let own = state[position_at(i)];
    let side = sphere_side(own, state[velocity_at(i)], state[momentum_at(i)]);
    let first = first_of(i);
    let partner = bonded_partner(i);
    let count = count_of(i);
    var chain = new_chain(i);
    begin_sums(local);
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        var push = no_push();
        if LAW != LAW_THESIS {
            new_keys[local] = NO_KEY;
        }
        let place = begin + local;
        let chunk = place - place % ENTRIES_PER_MASK;
        if (place < count) && ((hidden_entries(i, own, first, chunk, count) >> (place - chunk)) & 1u) == 0u {
            push = large_push(i, local, partner, own, side, entry_at(slot_at(first, place)), net);
        }
        let here = min(count - begin, WORKGROUP);
        add_in_order(local, here, push.force, 1.0, push.torque_per_arm, push.arm);
        if LAW != LAW_THESIS {
            put_springs_in_order(local, here, &chain);
            workgroupBarrier();
        }
    }
    workgroupBarrier();
    if (LAW != LAW_THESIS) & (local == 0u) & advances_springs() {
        end_chain(chain);
    }
    (*net).force = first_sum();
    (*net).torque = second_sum();
}

// The same as `sphere_load`, computed by a whole workgroup. Every thread gets the total force and torque, but only the contacts that it
// has counted itself.
fn load_by_workgroup(i: u32, local: u32) -> Net {
    var net = no_force();
    add_contacts_by_workgroup(i, local, &net);
    add_attachments(i, &net);
    return net;
}

// Returns the load of the sphere i of a thread, or of the large sphere of its workgroup. All threads of the workgroup must call it.
// `is_wanted` may differ between the threads of a workgroup, because another workgroup may reject the step at any time. In an early pass
// every sphere has one thread.
fn net_of(workgroup: u32, local: u32, i: u32, is_wanted: bool) -> Net {
    if serves_large_sphere(workgroup) & !is_early() {
        if broadcast_to_workgroup(local, u32(is_wanted)) == 0u {
            return no_force();
        }
        return load_by_workgroup(large_sphere_of(workgroup), local);
    }
    if (i < step.spheres) & is_wanted {
        return sphere_load(i);
    }
    return no_force();
}
