// requires model/counters.wgsl model/entries.wgsl model/lists.wgsl model/collision_state.wgsl model/order.wgsl model/step.wgsl physics/contact.wgsl
// requires physics/geometry.wgsl physics/surfaces_of_list.wgsl step/collisions/classify_contacts.wgsl step/collisions/crossing_rows.wgsl step/collisions/list_collisions.wgsl
// requires step/collisions/rows.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;
@group(0) @binding(7) var<storage, read> crossings: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(9) var<storage, read_write> collisions: array<vec4u>;

// Whether an entry of the workgroup's large sphere collides.
var<workgroup> any_collides: atomic<u32>;

// The contacts of a sphere whose crossing is handled do not collide (docs/physics section 3.10).
fn is_put_off(a: u32, b: u32) -> bool {
    if !CONTINUOUS {
        return false;
    }
    if has_handled_crossing(a) {
        return true;
    }
    return has_handled_crossing(b);
}

// Does what `mark_entries` and `list_all` do, for the large sphere of a workgroup. Each thread takes every WORKGROUP-th entry. All threads
// make the same number of rounds, because a barrier follows (see sweep_at_once.wgsl). Returns the number of collisions that this thread has
// counted.
fn mark_and_list_large_sphere(sphere: u32, local: u32) -> u32 {
    if local == 0u {
        atomicStore(&any_collides, 0u);
    }
    let count = broadcast_to_workgroup(local, count_of(sphere));
    let first = first_of(sphere);
    let own = own_of(sphere);
    let velocity = state[velocity_at(sphere)];
    var found = 0u;
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        let e = begin + local;
        if e >= count {
            continue;
        }
        let slot = slot_at(first, e);
        let other = load_entry(entry_at(slot), true);
        let chunk = e - e % ENTRIES_PER_MASK;
        let is_hidden = ((hidden_entries(sphere, own.place, first, chunk, count) >> (e - chunk)) & 1u) != 0u;
        if (mark_entry(own, velocity, other, slot, is_hidden) & ENTRY_COLLIDES) != 0u {
            atomicStore(&any_collides, 1u);
            found += select(0u, 1u, ordered(sphere, entry_id(other.entry)).x == sphere);
            list_entry(sphere, slot);
        }
    }
    workgroupBarrier();
    if local == 0u {
        mark_head(sphere, atomicLoad(&any_collides) != 0u);
    }
    return found;
}

@compute @workgroup_size(64)
fn find_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let workgroup = linear_group(group, groups);
    let mover = mover_of(workgroup, local);
    let is_rejected = was_rejected_before(ESCAPED_IN_COLLISIONS, REJECTED_COLLISIONS);
    let is_first_attempt = !is_rejected & (atomicLoad(&status.collided) == 0u);
    var found = 0u;
    if serves_large_sphere(workgroup) {
        if broadcast_to_workgroup(local, u32(is_first_attempt)) != 0u {
            if local == 0u {
                check_escape(mover);
            }
            found = mark_and_list_large_sphere(large_sphere_of(workgroup), local);
        }
    } else if (mover < step.spheres + step.rods) & is_first_attempt {
        if mover < step.spheres {
            check_escape(mover);
        }
        found = mark_entries(mover);
        if has_collisions(mover) {
            list_all(mover);
        }
    }
    count_collisions(workgroup, found);
}
