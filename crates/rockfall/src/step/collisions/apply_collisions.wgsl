// requires model/collision_state.wgsl model/lists.wgsl model/objects.wgsl model/put_next.wgsl model/step.wgsl
// requires physics/collision/capsule_changes.wgsl physics/collision/changes.wgsl physics/collision/impulses.wgsl
// requires physics/motion.wgsl step/collisions/has_changes.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl step/large_spheres/ordered_sums.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(7) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(8) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// What the collision of the entry in this slot adds to a sphere. The entry is in the list of `row`, a row
// of the sphere (see rows.wgsl).
fn part_of_entry(sphere: u32, row: u32, slot: vec2u) -> Part {
    let r = record_of(slot);
    let impulse = impulse_at(r);
    let velocity = part_on(sphere, row, r) * impulse.even;
    return Part(impulse_normal(r), velocity, velocity * max(impulse.tau, 0.0));
}

// Computes `changes_of` for a large sphere without rods, by its workgroup.
fn changes_of_large_sphere(sphere: u32, local: u32) -> Change {
    let count = count_of(sphere);
    let first = first_of(sphere);
    begin_sums(local);
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        var part = no_part();
        if begin + local < count {
            let slot = slot_at(first, begin + local);
            if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
                part = part_of_entry(sphere, sphere, slot);
            }
        }
        add_in_order(local, min(count - begin, WORKGROUP), part.n, part.velocity, part.n, part.position);
    }
    workgroupBarrier();
    return Change(first_sum(), second_sum());
}

// Writes the state of a sphere after its collisions.
fn write_change(i: u32) {
    if RODS {
        if network_of(i) != NO_NETWORK {
            let change = next[velocity_at(i)].xyz;
            let old = state[velocity_at(i)].xyz;
            write_motion(i, Motion(state[position_at(i)].xyz, low_row(i), old + change, state[momentum_at(i)].xyz));
            return;
        }
        let rod = capsule_with(i);
        if rod != NONE {
            write_capsule_end(i, rod);
            return;
        }
    }
    var change = Change(vec3f(0.0), vec3f(0.0));
    if inverse_mass(i) > 0.0 {
        change = changes_of(i);
    }
    write_changed(i, change);
}

fn apply_to_large_sphere(sphere: u32, local: u32) {
    if broadcast_to_workgroup(local, u32(takes_part_in_any(sphere) & has_changes())) == 0u {
        return;
    }
    // A sphere with rods has contacts in several lists. One thread goes through all of them.
    if broadcast_to_workgroup(local, u32((end_of(sphere) == NO_ROD) & (inverse_mass(sphere) > 0.0))) == 0u {
        if local == 0u {
            write_change(sphere);
        }
        return;
    }
    let change = changes_of_large_sphere(sphere, local);
    if local == 0u {
        write_changed(sphere, change);
    }
}

@compute @workgroup_size(64)
fn apply_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let workgroup = linear_group(group, groups);
    if serves_large_sphere(workgroup) {
        apply_to_large_sphere(large_sphere_of(workgroup), local);
        return;
    }
    let i = mover_of(workgroup, local);
    if i < step.spheres {
        // The first test excludes nearly all spheres by one word of the lists. Reading the status takes several times as long.
        if takes_part_in_any(i) {
            if has_changes() {
                write_change(i);
            }
        }
    }
}
