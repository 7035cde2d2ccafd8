// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/forces/mover_load.wgsl physics/forces/net_force.wgsl physics/forces/wrenches.wgsl physics/geometry.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

fn load_on(rod: u32) -> MoverLoad {
    var sum = no_load();
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

fn add_rod_contact(id: u32, own: Bar, entry: u32, sum: ptr<function, MoverLoad>) {
    let other = entry_id(entry);
    let a = min(id, other);
    let b = max(id, other);
    let found = touch_bar(id, own, other, entry_feature(entry));
    let a_side = side_of(a, found.a);
    let b_side = side_of(b, found.b);
    if !(found.overlap > 0.0) | (a_side.inverse_mass + b_side.inverse_mass <= 0.0) {
        return;
    }
    let is_a = id < other;
    add_contact(contact_force(a_side, b_side, found, a, b), select(found.b, found.a, is_a), is_a, found.overlap, sum);
}

// Whether forces are needed. Velocity Verlet mostly has those at the start of a step from the step before.
fn is_due() -> bool {
    return !VERLET | (pass_.index != 0u) | (status.forces_due != 0u);
}

@compute @workgroup_size(64)
fn rod_forces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let rod = linear_thread(group, groups, local);
    let alive = atomicLoad(&status.rejected) == 0u;
    var load = no_load();
    if alive & (rod < step.rods) & is_due() {
        load = load_on(rod);
        put_rod_load(rod, load);
    }
    if pass_.index == COUNTED {
        count_contacts_of_workgroup(linear_group(group, groups), local, load.contacts, load.deepest);
    }
    if (pass_.index == 0u) & alive & (rod == 0u) {
        status.lengths_due = 0u;
    }
}
