// requires model/collision_state.wgsl model/step.wgsl physics/collision/impulses.wgsl physics/collision/networks.wgsl
// requires step/collisions/has_changes.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> wrenches: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

var<workgroup> is_due: u32;

@compute @workgroup_size(64)
fn project_networks(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let number = linear_group(group, groups);
    if local == 0u {
        is_due = u32((number < step.networks) & has_changes());
    }
    if workgroupUniformLoad(&is_due) == 0u {
        return;
    }
    let network = network_at(number);
    put_directions(network, local);
    for (var first_place = 0u; first_place < network.spheres; first_place += WORKGROUP) {
        let place = first_place + local;
        if place < network.spheres {
            let sphere = network_sphere(network, place);
            next[position_at(sphere)] = vec4f(impulses_on(sphere, pass_.index), 0.0);
        }
    }
    project(network, local);
}
