// requires model/step.wgsl

// Gives an object that was counted its place among the sorted objects: those of one cell come in any order.
fn place_object(object: u32) {
    let key = atomicLoad(&cells[step.keys_at + object]);
    let place = atomicAdd(&cells[CELLS_AT + key], 1u);
    atomicStore(&cells[step.sorted_at + place], object);
    let aabb = aabbs[object];
    let half = 0.5 * aabb.max - 0.5 * aabb.min;
    // A little too large, so that no rounding makes it too small.
    let largest = 1.000001 * max(half.x, max(half.y, half.z));
    // The sign tells spheres from others.
    extents[place] = vec4f(0.5 * aabb.min + 0.5 * aabb.max, select(-largest, largest, object < step.spheres));
}
