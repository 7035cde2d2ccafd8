// requires model/step.wgsl

// The grid: which cell an object is in.
//
// The grid has levels of cells. The cells of a level are twice as large as those of the level below. Cells are half as wide
// along x as along y and z. A row of cells along x is one span of memory, and narrower cells make the ends of the span fit
// more closely.
//
// An object is in one cell: the cell of its centre on the lowest level, from `least_level` on, whose cells are not smaller
// than the object. So on every level an object that overlaps an AABB has its centre within half a cell of that AABB.
//
// The cells are in a table of fixed size. Cells that are neighbours along x are neighbours in the table. Rows are scattered
// over it. Two rows may share places of the table. That costs tests and makes duplicates, which `find_neighbours` drops, but
// it loses nothing.

// Returns whether boxes and polygons are so few that every mover tests them one by one. Levels of their own would cost every
// mover more.
fn are_statics_tested_apart() -> bool {
    return step.boxes + step.polygons <= FEW_STATICS;
}

// Edges of a cell, in units of the cell size of its level.
const CELL_SHAPE: vec3f = vec3f(0.5, 1.0, 1.0);

// The size of cells on a level.
fn cell_size(level: u32) -> f32 {
    return ldexp(step.cell_size, i32(level) - i32(LEVEL_BIAS));
}

fn largest_edge(aabb: Aabb) -> f32 {
    let extent = aabb.max - aabb.min;
    return max(extent.x, max(extent.y, extent.z));
}

// The lowest level whose cells are as large as the AABB: from one level to the next, the exponent of the size grows by 1. It has no loop,
// because barriers follow (see sweep_at_once.wgsl).
fn level_of(aabb: Aabb) -> u32 {
    let above = bitcast<i32>(abs(largest_edge(aabb))) - bitcast<i32>(cell_size(LEVEL_BIAS)) + 0x7fffff;
    return u32(clamp(i32(LEVEL_BIAS) + (above >> 23u), i32(step.least_level), i32(TOP_LEVEL)));
}

// Returns whether a mover is long: its AABB is on LONG_LEVEL or above, so that it has to test hundreds of objects. A
// workgroup builds its list.
fn is_long(aabb: Aabb) -> bool {
    return (step.long_at != 0u) & !(largest_edge(aabb) <= cell_size(LONG_LEVEL - 1u));
}

// Returns the cell of a place. The coordinates are clamped, so that places far out or at infinity have a cell too. Clamping
// keeps the order of coordinates.
fn cell_coordinates(place: vec3f, level: u32) -> vec3i {
    if level == TOP_LEVEL {
        return vec3i(0);
    }
    let far = vec3f(1073741824.0);
    return vec3i(clamp(floor(place / (cell_size(level) * CELL_SHAPE)), -far, far));
}

fn row_key(y: i32, z: i32, level: u32) -> u32 {
    return u32(y) * ROW_Y + u32(z) * ROW_Z + level * ROW_LEVEL;
}

// Returns the place of a cell in the table.
fn cell_key(x: i32, row: u32) -> u32 {
    return (u32(x) + row) & (step.cells - 1u);
}
