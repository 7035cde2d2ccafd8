// requires model/objects.wgsl model/collision_state.wgsl model/step.wgsl physics/collision.wgsl physics/collision/impulses.wgsl
// requires physics/collision/cluster.wgsl step/collisions/has_changes.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl step/large_spheres/workgroup_per_sphere.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read_write> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The change of velocity of a sphere that is not the end of a capsule, after this number of sweeps.
fn change_of(sphere: u32, sweeps: u32) -> vec3f {
    let w = inverse_mass(sphere);
    if w <= 0.0 {
        return vec3f(0.0);
    }
    if is_large(sphere) {
        return next[velocity_at(sphere)].xyz;
    }
    if RODS {
        if network_of(sphere) != NO_NETWORK {
            return next[velocity_at(sphere)].xyz;
        }
    }
    return w * impulses_on(sphere, sweeps);
}

// The change of velocity of one side of a contact, at the contact, after this number of sweeps.
fn change_at(half: ContactSide, sweeps: u32) -> vec3f {
    if half.kind == STATIC {
        return vec3f(0.0);
    }
    if !RODS | (half.kind == SPHERE) {
        return change_of(half.spheres.x, sweeps);
    }
    if half.kind == ROD {
        return (1.0 - half.at) * change_of(half.spheres.x, sweeps) + half.at * change_of(half.spheres.y, sweeps);
    }
    let rod = capsule_rod(half.spheres.x);
    let capsule = capsule_of(half.spheres, side_motion(half));
    let kick = capsule_change(capsule, rod, sweeps);
    return kick.velocity + cross(kick.spin, (half.at - capsule.centre) * capsule.d);
}

fn sweep(r: u32) {
    if !is_shared(r) {
        return;
    }
    let sweeps = pass_.index;
    var change = change_by_neighbours(r, neighbours_of(r), sweeps);
    let gathered = collisions[row_at(r, 2u)].x & (GATHERED_A | GATHERED_B);
    // Before the first sweep no velocity has changed, and nothing has been gathered.
    if (gathered != 0u) & (sweeps != 0u) {
        let k = record_at(r);
        if (gathered & GATHERED_A) != 0u {
            change += dot(k.n, change_at(contact_side(k.a_id, k.a), sweeps));
        }
        if (gathered & GATHERED_B) != 0u {
            change -= dot(k.n, change_at(contact_side(k.b_id, k.b), sweeps));
        }
    }
    put_sweep(r, sweeps, change);
}

@compute @workgroup_size(64)
fn sweep_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !has_changes() {
        return;
    }
    if atomicLoad(&status.clustered) == 0u {
        return;
    }
    let records = listed_records();
    for (var r = linear_thread(group, groups, local); r < records; r += groups.x * groups.y * WORKGROUP) {
        sweep(r);
    }
}
