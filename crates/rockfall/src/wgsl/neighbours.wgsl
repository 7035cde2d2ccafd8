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

// Whether there are more rows of cells to look at than objects, or more cells than the table has. In floats, for the product of very
// large counts.
fn covers_too_much(range: CellRange) -> bool {
    let size = vec3f(range.high) - vec3f(range.low) + 1.0;
    return (size.y * size.z > f32(objects())) | (size.x * size.y * size.z >= f32(step.cells));
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

fn may_meet(a: u32, b: u32) -> bool {
    // Two spheres whose balls are apart are not found in the first place.
    if (a < step.spheres) & (b < step.spheres) {
        if (step.flags & FLAG_GROUPS) == 0u {
            return true;
        }
        return ((words[step.tags_at + a] ^ words[step.tags_at + b]) & 0xffffu) == 0u;
    }
    return aabbs_meet(aabbs[a], aabbs[b]);
}

// Entries that what was found makes in the list of a mover: none for itself, nor for one of few statics that was met in a cell,
// for those are tested one by one.
fn entries_found(mover: u32, place: u32) -> u32 {
    let id = id_at(place);
    let is_known = ((place & AN_ID) == 0u) & (id >= step.spheres + step.rods) & statics_stand_apart();
    if (id == mover) | is_known {
        return 0u;
    }
    if !may_meet(mover, id) {
        return 0u;
    }
    return entries_of(mover, id);
}

// What of a search a thread does, where `across` times `across` threads share it: rows of cells so far apart along y and z.
struct Portion {
    y: i32,
    z: i32,
    across: i32,
}

const ALL_OF_IT = Portion(0, 0, 1);
const TEAM_ACROSS: i32 = 16;

// That of a thread of a workgroup of 256.
fn portion_of(local: u32) -> Portion {
    return Portion(i32(local) % TEAM_ACROSS, i32(local) / TEAM_ACROSS, TEAM_ACROSS);
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
fn test_span(mover: u32, probe: Probe, span: Span, stride: u32) {
    for (var first = span.start; first < span.end; first += stride) {
        for (var rest = close_in(probe, first, min(span.end - first, 32u)); rest != 0u; rest &= rest - 1u) {
            emit(mover, first + firstTrailingBit(rest));
        }
    }
}

fn emit_neighbours(mover: u32, portion: Portion) {
    let own = aabbs[mover];
    let probe = probe_of(mover, own);
    let thread = u32(portion.y + portion.z * portion.across);
    let threads = u32(portion.across * portion.across);
    if statics_stand_apart() {
        for (var id = step.spheres + step.rods + thread; id < objects(); id += threads) {
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
        var y = range.low.y + portion.y;
        var z = range.low.z + portion.z;
        var part = 0u;
        while all_of_them | ((y <= range.high.y) & (z <= range.high.z)) {
            var span = Span(32u * thread, objects());
            if !all_of_them {
                span = span_of_row(range, y, z, level, part);
            }
            test_span(mover, probe, span, select(32u, 32u * threads, all_of_them));
            if all_of_them {
                return;
            }
            part += 1u;
            if part == 2u {
                part = 0u;
                y += portion.across;
                if y > range.high.y {
                    y = range.low.y + portion.y;
                    z += portion.across;
                }
            }
        }
    }
}
