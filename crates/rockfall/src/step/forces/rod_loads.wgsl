// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/chain.wgsl physics/forces/due.wgsl physics/forces/net_force.wgsl physics/forces/rod_load.wgsl physics/geometry.wgsl
// requires physics/laws/history.wgsl physics/laws/mover_contact.wgsl physics/seams_of_list.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// Contacts by the law of the thesis.
fn add_contacts(rod: u32, sum: ptr<function, RodLoad>) {
    let id = step.spheres + rod;
    let count = count_of(id);
    let first = first_of(id);
    let own = bar_of(rod);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        let touching = touching_rod(id, own, 0u, first, begin, count) & ~hidden_edges(own, first, begin, count);
        for (var rest = touching; rest != 0u; rest &= rest - 1u) {
            add_contact(id, own, entry_at(slot_at(first, begin + firstTrailingBit(rest))), sum);
        }
    }
}

fn add_contact(id: u32, own: Bar, entry: u32, sum: ptr<function, RodLoad>) {
    let other = entry_id(entry);
    let a = min(id, other);
    let b = max(id, other);
    let feature = entry_feature(entry);
    let found = uncovered(a, b, touch_bar(id, own, other, feature));
    let a_side = side_of(a, found.a);
    let b_side = second_side(a, b, found);
    if !(found.overlap > 0.0) | (a_side.inverse_mass + b_side.inverse_mass <= 0.0) {
        return;
    }
    let is_a = id < other;
    let contact = contact_force(a_side, b_side, found, a, b);
    let force = select(-contact.force, contact.force, is_a);
    let push = Push(force, contact.torque_per_arm, select(contact.arm_b, contact.arm_a, is_a), found.overlap);
    add_to_ends(push, select(found.b, found.a, is_a), is_a, sum);
}

// Contacts by a law with history.
fn add_law_contacts(rod: u32, sum: ptr<function, RodLoad>) {
    let id = step.spheres + rod;
    var chain = new_chain(id);
    let count = count_of(id);
    let first = first_of(id);
    let own = bar_of(rod);
    var hidden = 0u;
    for (var e = 0u; e < count; e++) {
        if e % ENTRIES_PER_MASK == 0u {
            hidden = hidden_edges(own, first, e, count);
        }
        if ((hidden >> (e % ENTRIES_PER_MASK)) & 1u) != 0u {
            continue;
        }
        let entry = entry_at(slot_at(first, e));
        let met = mover_contact(id, entry);
        if !met.touches {
            continue;
        }
        add_to_ends(met.push, met.at, met.is_a, sum);
        if met.owns {
            put_spring(entry_key(entry_id(entry), entry_feature(entry)), met.spring, &chain);
        }
    }
    if advances_springs() {
        end_chain(chain);
    }
}

fn put_load(rod: u32, load: RodLoad) {
    wrenches[4u * rod] = vec4f(load.force_1, 0.0);
    wrenches[4u * rod + 1u] = vec4f(load.torque_1, 0.0);
    wrenches[4u * rod + 2u] = vec4f(load.force_2, 0.0);
    wrenches[4u * rod + 3u] = vec4f(load.torque_2, 0.0);
}

@compute @workgroup_size(64)
fn rod_loads(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    begin_contacts(local);
    let rod = linear_thread(group, groups, local);
    var load = no_rod_load();
    if (rod < step.rods) & are_loads_wanted(0u) & are_loads_due() {
        if LAW == LAW_THESIS {
            add_contacts(rod, &load);
        } else {
            add_law_contacts(rod, &load);
        }
        put_load(rod, load);
    }
    if evaluation() == COUNTED {
        count_contacts_of_workgroup(linear_group(group, groups), load.contacts, load.deepest);
    }
}
