// requires model/step.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read> status: Status;

// Gives every counted object its place among the sorted objects. Objects of the same cell come in any order.
@compute @workgroup_size(256)
fn sort_cells(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let object = wide_thread(group, groups, local);
    if !builds_lists(REBUILD_REQUESTED) | (object >= objects()) {
        return;
    }
    let key = atomicLoad(&cells[step.keys_at + object]);
    let place = atomicAdd(&cells[CELLS_AT + key], 1u);
    atomicStore(&cells[step.sorted_at + place], object);
    let aabb = aabbs[object];
    let half = 0.5 * aabb.max - 0.5 * aabb.min;
    // Slightly enlarged, so that rounding cannot make it too small.
    let largest = 1.000001 * max(half.x, max(half.y, half.z));
    // The sign distinguishes spheres from other objects.
    extents[place] = vec4f(0.5 * aabb.min + 0.5 * aabb.max, select(-largest, largest, object < step.spheres));
}
