// All objects that a mover may meet, itself and some more, from the cells around it. The stage says in `emit` what becomes of
// them. They come in any order, as places among the sorted objects or marked ids, and one may come twice.
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

// Marks an id among places of sorted objects.
const AN_ID: u32 = 0x80000000u;

fn id_at(place: u32) -> u32 {
    if (place & AN_ID) != 0u {
        return place & ~AN_ID;
    }
    return cells[step.sorted_at + place];
}

// What a mover looks around with. Rounding of centres, which grows with the distance from the origin, must not lose a pair that
// AABBs decide on.
struct Probe {
    centre: vec3f,
    reach: vec3f,
    // Radius of the ball that a sphere's AABB encloses, half its size; negative: no sphere.
    ball: f32,
}

fn probe_of(mover: u32, own: Aabb) -> Probe {
    let centre = 0.5 * own.min + 0.5 * own.max;
    let reach = 0.500002 * (own.max - own.min) + 1e-6 * abs(centre);
    return Probe(centre, reach, select(-1.0, max(max(reach.x, reach.y), reach.z), mover < step.spheres));
}

// 1 where a sorted object is not known to be far: of two spheres, where the balls meet. What has no bounds has no centre, and is
// far from nothing. The AABBs themselves have the last word, later.
fn is_close(probe: Probe, other: vec4f) -> u32 {
    let apart = other.xyz - probe.centre;
    let touching = probe.ball + other.w;
    let boxes_apart = any(abs(apart) > probe.reach + vec3f(abs(other.w)));
    let balls_apart = dot(apart, apart) > touching * touching;
    return select(1u, 0u, boxes_apart | (balls_apart & (other.w >= 0.0) & (probe.ball >= 0.0)));
}

// Which of up to 32 sorted objects are close. Four at a time, so that memory is asked for all of them at once.
fn close_in(probe: Probe, first: u32, count: u32) -> u32 {
    var close = 0u;
    let last = first + count - 1u;
    for (var k = 0u; k < count; k += 4u) {
        let a = extents[first + k];
        let b = extents[min(first + k + 1u, last)];
        let c = extents[min(first + k + 2u, last)];
        let d = extents[min(first + k + 3u, last)];
        close |= (is_close(probe, a) | is_close(probe, b) << 1u | is_close(probe, c) << 2u | is_close(probe, d) << 3u) << k;
    }
    return close & (0xffffffffu >> (32u - count));
}

// Emits what is close in a span. Neighbouring threads find at different times, and what a find makes one of them do all wait for:
// so they look first, and then go through what they found together.
fn test_span(mover: u32, probe: Probe, span: Span) {
    for (var first = span.start; first < span.end; first += 32u) {
        for (var rest = close_in(probe, first, min(span.end - first, 32u)); rest != 0u; rest &= rest - 1u) {
            emit(mover, first + firstTrailingBit(rest));
        }
    }
}

fn emit_neighbours(mover: u32) {
    let own = aabbs[mover];
    let probe = probe_of(mover, own);
    if statics_stand_apart() {
        for (var id = step.spheres + step.rods; id < objects(); id++) {
            if aabbs_meet(own, aabbs[id]) {
                emit(mover, id | AN_ID);
            }
        }
    }
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
            test_span(mover, probe, span);
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
