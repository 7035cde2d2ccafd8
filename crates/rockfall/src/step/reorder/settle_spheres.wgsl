// requires model/step.wgsl

@group(0) @binding(2) var<storage, read_write> start: array<vec4u>;
@group(0) @binding(3) var<storage, read> y3: array<vec4u>;
@group(0) @binding(4) var<storage, read> y4: array<vec4u>;
@group(0) @binding(5) var<storage, read_write> orientations: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> topology: array<u32>;
@group(0) @binding(7) var<storage, read> status: Status;

// Replaces the old memory slot of a sphere in a topology word by the new one.
fn follow(at: u32) {
    topology[at] = y4[2u * step.spheres + topology[at]].x;
}

// Updates all records that refer to spheres. The threads of the spheres share the work.
fn follow_all(thread: u32) {
    for (var rod = thread; rod < step.rods; rod += step.spheres) {
        follow(step.rods_at + rod * ROD_WORDS);
        follow(step.rods_at + rod * ROD_WORDS + 1u);
    }
    for (var at = step.springs_at + thread * SPRING_WORDS; at < step.tethers_at; at += step.spheres * SPRING_WORDS) {
        follow(at);
        follow(at + 1u);
    }
    for (var at = step.tethers_at + thread * TETHER_WORDS; at < step.forces_at; at += step.spheres * TETHER_WORDS) {
        follow(at);
    }
}

@compute @workgroup_size(64)
fn settle_spheres(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (status.rejected != 0u) {
        return;
    }
    for (var region = 0u; region < STATE_REGIONS; region++) {
        start[region * step.spheres + i] = y3[region * step.spheres + i];
    }
    if RESIDUES {
        start[RESIDUE_REGION * step.spheres + i] = y3[RESIDUE_REGION * step.spheres + i];
    }
    orientations[i] = y4[i];
    let own = y4[step.spheres + i];
    topology[step.tags_at + i] = own.x;
    topology[step.insertion_indices_at + i] = own.y;
    topology[step.slots_at + own.y] = i;
    if step.adjacency_at != 0u {
        topology[step.adjacency_at + 2u * i] = own.z;
        topology[step.adjacency_at + 2u * i + 1u] = own.w;
    }
    if step.ends_at != 0u {
        let moved = y4[2u * step.spheres + i];
        topology[step.ends_at + moved.x] = moved.y;
    }
    follow_all(i);
}
