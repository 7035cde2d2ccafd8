// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/net_force.wgsl physics/forces/wrenches.wgsl physics/geometry.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

// The force and the torque on each end of a rod, and the counters of its contacts.
struct Wrench {
    force_1: vec3f,
    torque_1: vec3f,
    force_2: vec3f,
    torque_2: vec3f,
    contacts: u32,
    deepest: f32,
}

fn no_wrench() -> Wrench {
    return Wrench(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0u, 0.0);
}

fn side_at(id: u32, at: f32) -> Side {
    if id < step.spheres {
        return sphere_side(state[position_at(id)], state[velocity_at(id)], state[momentum_at(id)]);
    }
    return other_side(id, at);
}

fn wrench_on(rod: u32) -> Wrench {
    var sum = no_wrench();
    let id = step.spheres + rod;
    let count = count_of(id);
    let first = first_of(id);
    let own = bar_of(rod);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = touching_rod(id, own, 0u, first, begin, count); rest != 0u; rest &= rest - 1u) {
            add_rod_contact(id, own, entry_at(slot_at(first, begin + firstTrailingBit(rest))), &sum);
        }
    }
    return sum;
}

fn add_rod_contact(id: u32, own: Bar, entry: u32, sum: ptr<function, Wrench>) {
    let other = entry_id(entry);
    let a = min(id, other);
    let b = max(id, other);
    let found = touch_bar(id, own, other, entry_feature(entry));
    let a_side = side_at(a, found.a);
    let b_side = side_at(b, found.b);
    if (found.overlap <= 0.0) | (a_side.inverse_mass + b_side.inverse_mass <= 0.0) {
        return;
    }
    let contact = contact_force(a_side, b_side, found, a, b);
    let is_a = id < other;
    let at = select(found.b, found.a, is_a);
    let force = select(-contact.force, contact.force, is_a);
    let torque = select(contact.arm_b, contact.arm_a, is_a) * contact.torque_per_arm;
    (*sum).force_1 += (1.0 - at) * force;
    (*sum).torque_1 += (1.0 - at) * torque;
    (*sum).force_2 += at * force;
    (*sum).torque_2 += at * torque;
    if is_a {
        (*sum).contacts += 1u;
        (*sum).deepest = max((*sum).deepest, found.overlap);
    }
}

@compute @workgroup_size(64)
fn rod_forces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let rod = linear_thread(group, groups, local);
    let alive = atomicLoad(&status.rejected) == 0u;
    var wrench = no_wrench();
    if alive & (rod < step.rods) {
        wrench = wrench_on(rod);
        wrenches[4u * rod] = vec4f(wrench.force_1, 0.0);
        wrenches[4u * rod + 1u] = vec4f(wrench.torque_1, 0.0);
        wrenches[4u * rod + 2u] = vec4f(wrench.force_2, 0.0);
        wrenches[4u * rod + 3u] = vec4f(wrench.torque_2, 0.0);
    }
    if pass_.index == 0u {
        count_contacts_of_workgroup(linear_group(group, groups), local, wrench.contacts, wrench.deepest);
        if alive & (rod == 0u) {
            status.lengths_due = 0u;
        }
    }
}
