// requires model/one_state.wgsl model/put_next.wgsl model/step.wgsl physics/escape.wgsl physics/forces/net_force.wgsl
// requires physics/forces/wrenches.wgsl step/integrate/next_state.wgsl step/large_spheres/large_sphere_forces.wgsl
// requires step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> start: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

fn start_row(region: u32, i: u32) -> vec4f {
    return start[region * step.spheres + i];
}

@compute @workgroup_size(64)
fn advance(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let workgroup = linear_group(group, groups);
    let i = mover_of(workgroup, local);
    let net = net_of(workgroup, local);
    if (i < step.spheres) & is_writer(workgroup, local) & (atomicLoad(&status.rejected) == 0u) {
        write_next(i, net);
    }
    if pass_.index == 0u {
        if (i == 0u) & (atomicLoad(&status.rejected) == 0u) {
            count_rebuild();
        }
        count_contacts_of_workgroup(workgroup, local, net.contacts, net.deepest);
    }
}
