// requires model/objects.wgsl model/one_state.wgsl model/put_rates.wgsl model/step.wgsl physics/forces/sphere_rates.wgsl
// requires physics/forces/wrenches.wgsl
// requires step/large_spheres/large_sphere_forces.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> kept_rates: array<f32>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(64)
fn starting_forces(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    // All threads of a workgroup must take the same branch, because `net_of` has barriers.
    if broadcast_to_workgroup(local, status.forces_due) == 0u {
        return;
    }
    let workgroup = linear_group(group, groups);
    let i = mover_of(workgroup, local);
    let net = net_of(workgroup, local);
    if (i >= step.spheres) | !is_writer(workgroup, local) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    let own = inverse_mass(i);
    if own > 0.0 {
        put_rates(i, sphere_rates(i, own, net));
    }
}
