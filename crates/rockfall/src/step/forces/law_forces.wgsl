// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/net_force.wgsl physics/forces/wrenches.wgsl physics/geometry.wgsl physics/laws/contact.wgsl
// requires physics/laws/history.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// The loads of a mover: of a sphere those of end 1, of a rod those of both ends.
struct MoverLoad {
    force_1: vec3f,
    torque_1: vec3f,
    force_2: vec3f,
    torque_2: vec3f,
    contacts: u32,
    deepest: f32,
    // Number of springs that the mover owns.
    owned: u32,
}

fn no_load() -> MoverLoad {
    return MoverLoad(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0u, 0.0, 0u);
}

fn law_side(id: u32, at: f32) -> Side {
    if id < step.spheres {
        return sphere_side(state[position_at(id)], state[velocity_at(id)], state[momentum_at(id)]);
    }
    return other_side(id, at);
}

fn add_law_contact(mover: u32, entry: u32, sum: ptr<function, MoverLoad>) {
    let feature = entry_feature(entry);
    let pair = ordered(mover, entry_id(entry));
    let found = touch(pair.x, pair.y, feature);
    if found.overlap <= 0.0 {
        return;
    }
    let a_side = law_side(pair.x, found.a);
    let b_side = law_side(pair.y, found.b);
    if a_side.inverse_mass + b_side.inverse_mass <= 0.0 {
        return;
    }
    let law = law_force(a_side, b_side, found, pair.x, pair.y, spring_of(pair.x, pair.y, feature));
    let is_a = mover == pair.x;
    if first_owns(pair.x, pair.y) == is_a {
        if (*sum).owned < step.history_room {
            put_spring(mover, (*sum).owned, entry_key(entry_id(entry), feature), law.spring);
        }
        (*sum).owned += 1u;
    }
    let force = select(-law.contact.force, law.contact.force, is_a);
    let torque = select(law.contact.arm_b, law.contact.arm_a, is_a) * law.contact.torque_per_arm;
    var at = 0.0;
    if RODS & (mover >= step.spheres) {
        at = select(found.b, found.a, is_a);
    }
    (*sum).force_1 += (1.0 - at) * force;
    (*sum).torque_1 += (1.0 - at) * torque;
    (*sum).force_2 += at * force;
    (*sum).torque_2 += at * torque;
    if is_a {
        (*sum).contacts += 1u;
        (*sum).deepest = max((*sum).deepest, found.overlap);
    }
}

fn load_on(mover: u32) -> MoverLoad {
    var sum = no_load();
    let count = count_of(mover);
    let first = first_of(mover);
    for (var e = 0u; e < count; e++) {
        add_law_contact(mover, entry_at(slot_at(first, e)), &sum);
    }
    end_row(mover, sum.owned);
    return sum;
}

fn put_load(mover: u32, load: MoverLoad) {
    if RODS & (mover >= step.spheres) {
        let at = 4u * (mover - step.spheres);
        wrenches[at] = vec4f(load.force_1, 0.0);
        wrenches[at + 1u] = vec4f(load.torque_1, 0.0);
        wrenches[at + 2u] = vec4f(load.force_2, 0.0);
        wrenches[at + 3u] = vec4f(load.torque_2, 0.0);
        return;
    }
    let at = 4u * step.rods + 2u * mover;
    wrenches[at] = vec4f(load.force_1, 0.0);
    wrenches[at + 1u] = vec4f(load.torque_1, 0.0);
}

@compute @workgroup_size(64)
fn law_forces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    // Another thread of this dispatch may reject the step because of its springs. Then no result is used.
    let alive = (atomicLoad(&status.rejected) & ~REJECTED_HISTORY) == 0u;
    var load = no_load();
    if alive & (mover < step.spheres + step.rods) {
        load = load_on(mover);
        put_load(mover, load);
        if load.owned > step.history_room {
            atomicOr(&status.rejected, REJECTED_HISTORY);
        }
    }
    count_contacts_of_workgroup(linear_group(group, groups), local, load.contacts, load.deepest);
    if alive & (mover == 0u) {
        status.lengths_due = 0u;
    }
}
