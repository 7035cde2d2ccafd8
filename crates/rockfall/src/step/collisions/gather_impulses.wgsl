// requires model/lists.wgsl model/objects.wgsl model/collision_state.wgsl model/step.wgsl physics/collision/impulses.wgsl
// requires step/collisions/has_changes.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl step/large_spheres/ordered_sums.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// Computes `impulses_on` for a large sphere without rods, by its workgroup.
fn impulses_on_large_sphere(sphere: u32, local: u32) -> vec3f {
    let count = count_of(sphere);
    let first = first_of(sphere);
    begin_sums(local);
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        var n = vec3f(0.0);
        var part = 0.0;
        if begin + local < count {
            let slot = slot_at(first, begin + local);
            if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
                let r = record_of(slot);
                n = impulse_normal(r);
                part = impulse_after(r, pass_.index) * part_on(sphere, sphere, r);
            }
        }
        add_in_order(local, min(count - begin, WORKGROUP), n, part, vec3f(0.0), 0.0);
    }
    workgroupBarrier();
    return first_sum();
}

@compute @workgroup_size(64)
fn gather_impulses(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let number = linear_group(group, groups);
    if number >= step.large {
        return;
    }
    let sphere = large_sphere_of(number);
    // `project_networks` has computed the changes of the spheres of networks.
    let is_own = (inverse_mass(sphere) > 0.0) & (!RODS || (network_of(sphere) == NO_NETWORK));
    let is_due = has_changes() & (atomicLoad(&status.clustered) != 0u) & is_own;
    if broadcast_to_workgroup(local, u32(is_due)) == 0u {
        return;
    }
    // A sphere with rods has contacts in several lists. One thread goes through all of them.
    var sum = vec3f(0.0);
    if broadcast_to_workgroup(local, u32(end_of(sphere) == NO_ROD)) != 0u {
        sum = impulses_on_large_sphere(sphere, local);
    } else if local == 0u {
        sum = impulses_on(sphere, pass_.index);
    }
    if local == 0u {
        next[velocity_at(sphere)] = vec4f(inverse_mass(sphere) * sum, 0.0);
    }
}
