// requires model/early.wgsl model/load_rows.wgsl model/one_state.wgsl model/step.wgsl physics/escape.wgsl physics/rotation.wgsl
// requires step/integrate/symplectic_euler_state.wgsl physics/rigid.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(7) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// An early pass leaves the state as it is for the pass that computes all spheres.
fn put_start(region: u32, i: u32, row: vec4f) {
    if is_early() {
        y3[region * step.spheres + i] = row;
    } else {
        state[region * step.spheres + i] = row;
    }
}

@compute @workgroup_size(256)
fn symplectic_euler(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var i = wide_thread(group, groups, local);
    if is_early() {
        i = sent_sphere(i);
    }
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    if LATE_TURN {
        y3[position_at(i)] = vec4f(state[position_at(i)].xyz, 0.0);
    }
    let spin = symplectic_euler_sphere(i, load_of(i));
    if is_early() {
        return;
    }
    if LATE_TURN {
        y3[momentum_at(i)] = vec4f(spin, 0.0);
    } else {
        turn_by(i, rotation(spin));
    }
    if is_free(i) {
        request_rebuild(i, state[position_at(i)], state[velocity_at(i)]);
    }
}
