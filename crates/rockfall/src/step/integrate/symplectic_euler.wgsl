// requires model/one_state.wgsl model/put_next.wgsl model/step.wgsl physics/escape.wgsl physics/forces/net_force.wgsl
// requires physics/forces/wrenches.wgsl step/integrate/symplectic_euler_state.wgsl
// requires step/large_spheres/large_sphere_forces.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// Keeps data of a sphere for the later stages of a step with rods.
fn remember(i: u32, old_position: vec3f, spin: vec3f) {
    y3[position_at(i)] = vec4f(old_position, 0.0);
    y3[momentum_at(i)] = vec4f(spin, 0.0);
}

@compute @workgroup_size(64)
fn symplectic_euler(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let workgroup = linear_group(group, groups);
    let i = mover_of(workgroup, local);
    let net = net_of(workgroup, local);
    if (i < step.spheres) & is_writer(workgroup, local) & (atomicLoad(&status.rejected) == 0u) {
        write_symplectic_euler(i, net);
    }
    if (i == 0u) & (atomicLoad(&status.rejected) == 0u) {
        count_rebuild();
    }
    count_contacts_of_workgroup(workgroup, local, net.contacts, net.deepest);
}
