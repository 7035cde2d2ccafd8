@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> words: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(64)
fn find_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    var collisions = 0u;
    if (mover < step.spheres + step.rods) & (atomicLoad(&status.void) == 0u) & (atomicLoad(&status.collided) == 0u) {
        if mover < step.spheres {
            check_escape(mover);
        }
        collisions = mark_entries(mover);
    }
    tell_collisions(linear_group(group, groups), local, collisions);
}
