// Counts an object in its cell, and notes it if it is a long mover, in any order; gives its level, as a bit, 0 where nobody looks
// for it there.
fn count_object(object: u32) -> u32 {
    let aabb = aabbs[object];
    let level = level_of(aabb);
    let cell = cell_coordinates(0.5 * aabb.min + 0.5 * aabb.max, level);
    let key = cell_key(cell.x, row_key(cell.y, cell.z, level));
    atomicAdd(&cells[CELLS_AT + key], 1u);
    atomicStore(&cells[step.keys_at + object], key);
    if (object < step.spheres + step.rods) & is_long(aabb) {
        atomicStore(&cells[step.long_at + atomicAdd(&cells[3], 1u)], object);
    }
    return select(1u << level, 0u, (object >= step.spheres + step.rods) & statics_stand_apart());
}
