// requires model/lists.wgsl model/step.wgsl physics/contact.wgsl physics/forces/net_force.wgsl physics/geometry.wgsl
// requires step/large_spheres/ordered_sums.wgsl step/large_spheres/workgroup_per_sphere.wgsl

// Net forces on large spheres, with a workgroup per sphere. The threads compute one contact each, and the contact forces are
// added in the order of the list.

fn add_contacts_by_workgroup(i: u32, local: u32, net: ptr<function, Net>) {
    let own = state[position_at(i)];
    let side = sphere_side(own, state[velocity_at(i)], state[momentum_at(i)]);
    let first = first_of(i);
    let partner = bonded_partner(i);
    let count = count_of(i);
    begin_sums(local);
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        var push = no_push();
        if begin + local < count {
            let entry = entry_at(slot_at(first, begin + local));
            push = push_of(i, partner, own, side, load_entry(entry, true));
            count_push(i, entry, push, net);
        }
        add_in_order(local, min(count - begin, WORKGROUP), push.force, 1.0, push.torque_per_arm, push.arm);
    }
    workgroupBarrier();
    (*net).force = first_sum();
    (*net).torque = second_sum();
}

// The same as `net_in_pass`, computed by a whole workgroup. Every thread gets the total force and torque, but only the
// contacts that it has counted itself.
fn net_by_workgroup(i: u32, local: u32) -> Net {
    var net = no_force();
    add_contacts_by_workgroup(i, local, &net);
    add_attachments(i, &net);
    return net;
}

// Returns the net force on the mover of a thread, or on the large sphere of its workgroup. All threads of the workgroup must
// call it.
fn net_of(workgroup: u32, local: u32) -> Net {
    if serves_large_sphere(workgroup) {
        if broadcast_to_workgroup(local, atomicLoad(&status.rejected)) != 0u {
            return no_force();
        }
        return net_by_workgroup(large_sphere_of(workgroup), local);
    }
    let i = mover_of(workgroup, local);
    if (i < step.spheres) & (atomicLoad(&status.rejected) == 0u) {
        return net_in_pass(i);
    }
    return no_force();
}
