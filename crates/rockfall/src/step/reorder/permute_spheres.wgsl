// requires model/step.wgsl

// All data is copied as u32, so that the bits of floats cannot change.
@group(0) @binding(2) var<storage, read> start: array<vec4u>;
@group(0) @binding(3) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(4) var<storage, read> orientations: array<vec4u>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read_write> y3: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> y4: array<vec4u>;
@group(0) @binding(8) var<storage, read> status: Status;

@compute @workgroup_size(64)
fn permute_spheres(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (status.rejected != 0u) {
        return;
    }
    let from_ = pairs[i].y;
    for (var region = 0u; region < STATE_REGIONS; region++) {
        y3[region * step.spheres + i] = start[region * step.spheres + from_];
    }
    if RESIDUES {
        y3[RESIDUE_REGION * step.spheres + i] = start[RESIDUE_REGION * step.spheres + from_];
    }
    var attached = vec2u(0u);
    if step.adjacency_at != 0u {
        attached = vec2u(topology[step.adjacency_at + 2u * from_], topology[step.adjacency_at + 2u * from_ + 1u]);
    }
    var end = 0u;
    if step.ends_at != 0u {
        end = topology[step.ends_at + from_];
    }
    y4[i] = orientations[from_];
    y4[step.spheres + i] = vec4u(topology[step.tags_at + from_], topology[step.insertion_indices_at + from_], attached);
    y4[2u * step.spheres + from_] = vec4u(i, end, 0u, 0u);
}
