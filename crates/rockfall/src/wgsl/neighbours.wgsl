// All objects that a mover may meet, from the cells around it. The stage says in `emit` what becomes of an entry. Entries
// come in any order, and one may come twice.
//
// One loop within another within a third, and each function called from one place: graphics compilers inline everything.

// Objects `sorted[start..end]`.
struct Span {
    start: u32,
    end: u32,
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

// Whether there are more rows of cells to look at than objects. In floats, for the product of very large counts.
fn covers_too_much(range: CellRange, objects: u32) -> bool {
    let size = vec3f(range.high) - vec3f(range.low) + 1.0;
    return (size.y * size.z > f32(objects)) | (size.x >= f32(step.cells));
}

// A row of cells, which may go around the end of the table: then it has a second part.
fn span_of_row(range: CellRange, y: i32, z: i32, level: u32, part: u32, objects: u32) -> Span {
    let row = row_key(y, z, level);
    let first = cell_key(range.low.x, row);
    let last = cell_key(range.high.x, row);
    let end = cells[CELLS_AT + last];
    if part == 1u {
        return Span(0u, select(0u, end, first > last));
    }
    var start = 0u;
    if first > 0u {
        start = cells[CELLS_AT + first - 1u];
    }
    return Span(start, select(end, objects, first > last));
}

fn may_meet(a: Aabb, b: Aabb) -> bool {
    return all(a.min <= b.max) & all(b.min <= a.max) & (((a.tag ^ b.tag) & 0xffffu) == 0u);
}

// Emits what of a span the mover may meet.
fn test_span(mover: u32, own: Aabb, span: Span) {
    let movers = step.spheres + step.rods;
    let is_rod = RODS & (mover >= step.spheres);
    let centre = 0.5 * own.min + 0.5 * own.max;
    // Rounding of centres, which grows with the distance from the origin, must not lose a pair that AABBs decide on.
    let reach = 0.500001 * (own.max - own.min) + 5e-7 * abs(centre);
    for (var k = span.start; k < span.end; k++) {
        // Objects of a row stand side by side here; most are told apart by this alone.
        let other = extents[k];
        if any(abs(other.xyz - centre) > reach + vec3f(other.w) + 5e-7 * abs(other.xyz)) {
            continue;
        }
        let id = cells[step.sorted_at + k];
        if (id == mover) | (is_rod & (id >= movers + step.boxes)) {
            continue;
        }
        if !may_meet(own, aabbs[id]) {
            continue;
        }
        let features = select(1u, BOX_FEATURES, is_rod & (id >= movers));
        for (var feature = 0u; feature < features; feature++) {
            emit(id | feature << ENTRY_ID_BITS);
        }
    }
}

fn emit_neighbours(mover: u32) {
    let own = aabbs[mover];
    let objects = step.spheres + step.rods + step.boxes + step.polygons;
    var all_of_them = false;
    for (var rest = cells[0]; rest != 0u; rest &= rest - 1u) {
        all_of_them |= covers_too_much(cells_around(own, firstTrailingBit(rest)), objects);
    }
    for (var rest = cells[0]; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        var y = range.low.y;
        var z = range.low.z;
        var part = 0u;
        while z <= range.high.z {
            var span = Span(0u, objects);
            if !all_of_them {
                span = span_of_row(range, y, z, level, part, objects);
            }
            test_span(mover, own, span);
            if all_of_them {
                return;
            }
            part += 1u;
            if part == 2u {
                part = 0u;
                y += 1;
                if y > range.high.y {
                    y = range.low.y;
                    z += 1;
                }
            }
        }
    }
}
