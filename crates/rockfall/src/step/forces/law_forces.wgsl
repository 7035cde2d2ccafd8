// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/mover_load.wgsl physics/forces/net_force.wgsl physics/forces/wrenches.wgsl physics/geometry.wgsl
// requires physics/laws/contact.wgsl physics/laws/history.wgsl physics/laws/jkr.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// Adds a contact of a mover. Appends its spring to the chain of the mover if the mover owns it.
fn add_law_contact(mover: u32, entry: u32, sum: ptr<function, MoverLoad>, chain: ptr<function, Chain>) {
    let feature = entry_feature(entry);
    let pair = ordered(mover, entry_id(entry));
    var found = touch(pair.x, pair.y, feature);
    if found.overlap <= 0.0 {
        if COHESION {
            found = neck(pair.x, pair.y, feature, found);
        }
        if !COHESION | (found.overlap == NO_CONTACT_LINE) {
            return;
        }
    }
    let a_side = side_of(pair.x, found.a);
    let b_side = side_of(pair.y, found.b);
    if a_side.inverse_mass + b_side.inverse_mass <= 0.0 {
        return;
    }
    let law = law_force(a_side, b_side, found, pair.x, pair.y, spring_of(pair.x, pair.y, feature));
    let is_a = mover == pair.x;
    if (first_owns(pair.x, pair.y) == is_a) & advances_springs() {
        put_spring(entry_key(entry_id(entry), feature), law.spring, chain);
    }
    var at = 0.0;
    if RODS & (mover >= step.spheres) {
        at = select(found.b, found.a, is_a);
    }
    add_contact(law.contact, at, is_a, found.overlap, sum);
    if RESISTANCE {
        add_load(vec3f(0.0), select(-law.moment, law.moment, is_a), at, false, 0.0, sum);
    }
}

fn load_on(mover: u32) -> MoverLoad {
    var sum = no_load();
    var chain = new_chain(mover);
    let count = count_of(mover);
    let first = first_of(mover);
    for (var e = 0u; e < count; e++) {
        add_law_contact(mover, entry_at(slot_at(first, e)), &sum, &chain);
    }
    if advances_springs() {
        end_chain(chain);
    }
    return sum;
}

fn put_load(mover: u32, load: MoverLoad) {
    if RODS & (mover >= step.spheres) {
        put_rod_load(mover - step.spheres, load);
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
    // Another thread of this dispatch may reject the step because of its springs. Then no result is used. The end of that step says
    // how many blocks are needed.
    let alive = ((atomicLoad(&status.rejected) & ~REJECTED_HISTORY) == 0u) & (status.history_needed == 0u);
    let is_due = advances_springs() | (status.forces_due != 0u);
    var load = no_load();
    if alive & is_due & (mover < step.spheres + step.rods) {
        load = load_on(mover);
        put_load(mover, load);
    }
    if evaluation() == COUNTED {
        count_contacts_of_workgroup(linear_group(group, groups), local, load.contacts, load.deepest);
    }
    if alive & (evaluation() == 0u) & (mover == 0u) {
        status.lengths_due = 0u;
    }
}
