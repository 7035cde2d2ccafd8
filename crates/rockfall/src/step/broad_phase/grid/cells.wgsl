// requires model/step.wgsl

// The grid: which cell an object is in, and which cells it may find others in.
//
// Levels of cells, each twice as large as the one below, and half as wide along x: a row of them is one span of memory, which so is
// cut closer. An object is in one cell: that of its centre, on the lowest level (from `least_level` on)
// whose cells are not smaller than it. So what overlaps an AABB has its centre within half a cell of it, on every level.
// Cells live in a table of fixed size: along x they are neighbours, rows are scattered. Two rows may share places of the
// table; that costs tests and makes duplicates, which `find_neighbours` drops, but loses nothing.

// Few boxes and polygons are tested one by one: levels of their own would cost every mover more.
fn statics_stand_apart() -> bool {
    return step.boxes + step.polygons <= FEW_STATICS;
}

const CELL_SHAPE: vec3f = vec3f(0.5, 1.0, 1.0);

fn cell_size(level: u32) -> f32 {
    return ldexp(step.cell_size, i32(level) - i32(LEVEL_BIAS));
}

fn largest_edge(aabb: Aabb) -> f32 {
    let extent = aabb.max - aabb.min;
    return max(extent.x, max(extent.y, extent.z));
}

fn level_of(aabb: Aabb) -> u32 {
    let largest = largest_edge(aabb);
    var level = step.least_level;
    while level < TOP_LEVEL {
        if largest <= cell_size(level) {
            break;
        }
        level += 1u;
    }
    return level;
}

// Whether a mover looks at hundreds of objects: its AABB is on LONG_LEVEL or above. A workgroup makes its list.
fn is_long(aabb: Aabb) -> bool {
    return (step.long_at != 0u) & !(largest_edge(aabb) <= cell_size(LONG_LEVEL - 1u));
}

// Clamped, so that what is far out or infinite has a cell too: clamping keeps the order of coordinates.
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

fn cell_key(x: i32, row: u32) -> u32 {
    return (u32(x) + row) & (step.cells - 1u);
}
