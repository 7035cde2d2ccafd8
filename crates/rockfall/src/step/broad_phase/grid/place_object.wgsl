// requires model/step.wgsl

// Gives a counted object its place among the sorted objects. Objects of the same cell come in any order.
fn place_object(object: u32) {
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
