// All objects that a mover may meet, from the cells around it. A stage that uses it says in `emit` what becomes of an
// entry. Entries come in any order, and one may come twice.

fn start_of(key: u32) -> u32 {
    if key == 0u {
        return 0u;
    }
    return cells[CELLS_AT + key - 1u];
}

fn may_meet(a: Aabb, b: Aabb) -> bool {
    return all(a.min <= b.max) & all(b.min <= a.max) & (((a.tag ^ b.tag) & 0xffffu) == 0u);
}

// Tests the objects `sorted[start..end]`; `count` entries were emitted before, the sum is returned.
fn test_run(mover: u32, own: Aabb, start: u32, end: u32, before: u32) -> u32 {
    let movers = step.spheres + step.rods;
    let is_rod = mover >= step.spheres;
    var count = before;
    for (var k = start; k < end; k++) {
        let id = cells[step.sorted_at + k];
        if (id == mover) | (is_rod & (id >= movers + step.boxes)) {
            continue;
        }
        if !may_meet(own, aabbs[id]) {
            continue;
        }
        let features = select(1u, BOX_FEATURES, is_rod & (id >= movers));
        for (var feature = 0u; feature < features; feature++) {
            emit(mover, count, id | feature << ENTRY_ID_BITS);
            count += 1u;
        }
    }
    return count;
}

// Cells on a level within which the centre of an overlapping object lies. The slack covers rounding.
struct CellRange {
    low: vec3i,
    high: vec3i,
}

fn cells_around(own: Aabb, level: u32) -> CellRange {
    let slack = 0.5005 * cell_size(level) + 1e-6 * max(abs(own.min), abs(own.max));
    return CellRange(cell_coordinates(own.min - slack, level), cell_coordinates(own.max + slack, level));
}

fn emit_neighbours(mover: u32) -> u32 {
    let own = aabbs[mover];
    let objects = step.spheres + step.rods + step.boxes + step.polygons;
    let levels = cells[0];
    var count = 0u;
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        // In floats, for the product of very large counts.
        let size = vec3f(range.high) - vec3f(range.low) + 1.0;
        if (size.y * size.z > f32(objects)) | (size.x >= f32(step.cells)) {
            // More rows than objects: all of these are tested, for this level and all others.
            return test_run(mover, own, 0u, objects, 0u);
        }
    }
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        for (var z = range.low.z; z <= range.high.z; z++) {
            for (var y = range.low.y; y <= range.high.y; y++) {
                let row = row_key(y, z, level);
                let first = cell_key(range.low.x, row);
                let last = cell_key(range.high.x, row);
                if first <= last {
                    count = test_run(mover, own, start_of(first), cells[CELLS_AT + last], count);
                } else {
                    // Around the end of the table.
                    count = test_run(mover, own, start_of(first), cells[CELLS_AT + step.cells - 1u], count);
                    count = test_run(mover, own, 0u, cells[CELLS_AT + last], count);
                }
            }
        }
    }
    return count;
}
