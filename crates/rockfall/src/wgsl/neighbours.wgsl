// All objects that a mover may meet, and some more, from the cells around it. The stage says in `emit` what becomes of
// them. They come in any order, and one may come twice.
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
fn covers_too_much(range: CellRange) -> bool {
    let size = vec3f(range.high) - vec3f(range.low) + 1.0;
    return (size.y * size.z > f32(objects())) | (size.x >= f32(step.cells));
}

// A row of cells, which may go around the end of the table: then it has a second part.
fn span_of_row(range: CellRange, y: i32, z: i32, level: u32, part: u32) -> Span {
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
    return Span(start, select(end, objects(), first > last));
}

// Emits the objects of a span that are close to the mover: two spheres where the balls that their AABBs enclose meet.
// Neighbouring threads find at different times: what a find
// makes one of them do, all wait for, so this loop only looks at what stands side by side and leaves the last word, the
// AABBs themselves, for later.
fn test_span(mover: u32, centre: vec3f, reach: vec3f, ball: f32, span: Span) {
    for (var k = span.start; k < span.end; k++) {
        let other = extents[k];
        let id = cells[step.sorted_at + k];
        let apart = abs(other.xyz - centre);
        let slack = 1e-6 * abs(other.xyz);
        let touching = ball + other.w + max(max(slack.x, slack.y), slack.z);
        let far = any(apart > reach + vec3f(other.w) + slack) | ((id < step.spheres) & (dot(apart, apart) > touching * touching));
        if !(far | (id == mover)) {
            emit(mover, id);
        }
    }
}

fn emit_neighbours(mover: u32) {
    let own = aabbs[mover];
    let centre = 0.5 * own.min + 0.5 * own.max;
    // Rounding of centres, which grows with the distance from the origin, must not lose a pair that AABBs decide on.
    let slack = 1e-6 * abs(centre);
    let reach = 0.500001 * (own.max - own.min) + slack;
    // Half the size of a sphere's AABB is the radius of its ball; what is no sphere is no ball.
    let ball = select(1e30, max(max(reach.x, reach.y), reach.z), mover < step.spheres);
    var all_of_them = false;
    for (var rest = cells[0]; rest != 0u; rest &= rest - 1u) {
        all_of_them |= covers_too_much(cells_around(own, firstTrailingBit(rest)));
    }
    for (var rest = cells[0]; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        var y = range.low.y;
        var z = range.low.z;
        var part = 0u;
        while z <= range.high.z {
            var span = Span(0u, objects());
            if !all_of_them {
                span = span_of_row(range, y, z, level, part);
            }
            test_span(mover, centre, reach, ball, span);
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
