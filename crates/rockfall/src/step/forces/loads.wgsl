// requires model/counters.wgsl model/early.wgsl model/load_rows.wgsl model/one_state.wgsl model/step.wgsl physics/collision/hidden_crossing.wgsl physics/escape.wgsl physics/forces/due.wgsl
// requires physics/forces/load.wgsl physics/forces/net_force.wgsl physics/passage.wgsl physics/forces/rates.wgsl physics/forces/user.wgsl physics/rigid.wgsl step/large_spheres/large_sphere_load.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(7) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The load of the laws of the program on a sphere of a rigid body. Integrators add that on other spheres.
fn law_load(i: u32, inverse_mass: f32) -> Load {
    var load = Load(vec3f(0.0), vec3f(0.0));
    if !RIGID_BODIES {
        return load;
    }
    if !is_free(i) {
        var rates = Rates(vec3f(0.0), vec3f(0.0));
        add_user(i, &rates);
        load = Load(rates.acceleration / inverse_mass, rates.torque);
    }
    return load;
}

fn put_load(i: u32, net: Net, inverse_mass: f32) {
    let laws = law_load(i, inverse_mass);
    let at = load_at(i);
    wrenches[at] = vec4f(net.force + laws.force, 0.0);
    wrenches[at + 1u] = vec4f(net.torque + laws.torque, 0.0);
}

// Reports a sphere that is outside its AABB. In the last pass of several, requests new lists if it may soon leave it.
fn check_place(i: u32, velocity: vec4f) {
    let place = state[position_at(i)];
    let ratio = escape_ratio(place.xyz, place.w, aabbs[i]);
    if ratio > 0.0 {
        report_escape(ratio, ESCAPED_IN_LOADS + evaluation());
    }
    if evaluation() == 3u {
        request_rebuild(i, place, velocity);
    }
    if PASSAGES {
        if is_fast(place.w, velocity) {
            // A load is cheaper than an atomic write, and most find the word set.
            if atomicLoad(&status.counters[0].fast) == 0u {
                atomicStore(&status.counters[0].fast, 1u);
            }
        }
    }
}

@compute @workgroup_size(64)
fn loads(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    begin_contacts(local);
    let workgroup = linear_group(group, groups);
    let is_early = is_early();
    var i = mover_of(workgroup, local);
    if is_early {
        i = sent_sphere(linear_thread(group, groups, local));
    }
    let are_wanted = are_loads_wanted(escape_bit(ESCAPED_IN_LOADS + evaluation()));
    let are_due = are_loads_due();
    let net = net_of(workgroup, local, i, are_wanted & are_due);
    if (i < step.spheres) & (is_early | is_writer(workgroup, local)) & are_wanted {
        let velocity = state[velocity_at(i)];
        if velocity.w > 0.0 {
            if are_due {
                put_load(i, net, velocity.w);
            }
            check_place(i, velocity);
        }
        if (i == 0u) & (evaluation() == 0u) & !is_early {
            count_rebuild();
            status.lengths_due = 0u;
        }
    }
    if (evaluation() == COUNTED) & !is_early {
        count_contacts_of_workgroup(workgroup, net.contacts, net.deepest);
    }
}
