// requires model/step.wgsl step/broad_phase/grid/cells.wgsl step/broad_phase/meet.wgsl

// All objects that a mover may meet, itself and some more, from the cells around it. The stage says in `emit` what becomes of
// them. They come in any order, as places among the sorted objects or marked ids, and one may come twice.
//
// One loop within another within a third, and each function called from one place: graphics compilers inline everything.

// So many sorted objects from the first one on; after the last of all comes the first, for a row may go around the end of the table.
struct Span {
    first: u32,
    count: u32,
}

// Cells on a level within which the centre of an overlapping object lies. The slack covers rounding.
struct CellRange {
    low: vec3i,
    high: vec3i,
}

fn slack_around(own: Aabb, level: u32) -> vec3f {
    return 0.5005 * bitcast<f32>(cells[EDGES_AT + level]) + 1e-6 * max(abs(own.min), abs(own.max));
}

fn cells_around(own: Aabb, level: u32) -> CellRange {
    let slack = slack_around(own, level);
    return CellRange(cell_coordinates(own.min - slack, level), cell_coordinates(own.max + slack, level));
}

// Whether all objects on a level are so near the origin that an AABB cannot overlap them: what flies off as fast as it can, all alone,
// would have too many cells to look at.
fn is_beyond(own: Aabb, level: u32) -> bool {
    let slack = slack_around(own, level);
    let far = vec3f(bitcast<f32>(cells[FARTHEST_AT + level]));
    return any(own.min - slack > far) | any(own.max + slack < -far);
}

// Whether there are more rows of cells to look at than objects, or more cells than the table has. In floats, for the product of very
// large counts.
fn covers_too_much(range: CellRange) -> bool {
    let size = vec3f(range.high) - vec3f(range.low) + 1.0;
    return (size.y * size.z > f32(objects())) | (size.x * size.y * size.z >= f32(step.cells));
}

fn span_of_row(range: CellRange, y: i32, z: i32, level: u32) -> Span {
    let row = row_key(y, z, level);
    let first = cell_key(range.low.x, row);
    let last = cell_key(range.high.x, row);
    var start = 0u;
    if first > 0u {
        start = cells[CELLS_AT + first - 1u];
    }
    return Span(start, cells[CELLS_AT + last] - start + select(0u, objects(), first > last));
}

// Marks an id among places of sorted objects.
const AN_ID: u32 = 0x80000000u;

// Without a branch, so that memory is asked for several at a time; an id is a place, too, of some object.
fn id_at(place: u32) -> u32 {
    let bare = place & ~AN_ID;
    return select(cells[step.sorted_at + bare], bare, (place & AN_ID) != 0u);
}

// Where the rounding of centres, which grows with the distance from the origin, comes to so much, squares of distances may be beyond
// all numbers: then everything is found, and the AABBs have the last word on spheres, too.
const REMOTE: f32 = 1e12;

// Whether the mover that looks around is there.
var<private> is_remote: bool;

fn may_meet(a: u32, b: u32) -> bool {
    // Two spheres whose balls are apart are not found in the first place.
    if (a < step.spheres) & (b < step.spheres) & !is_remote {
        if (step.flags & FLAG_GROUPS) == 0u {
            return true;
        }
        return ((topology[step.tags_at + a] ^ topology[step.tags_at + b]) & 0xffffu) == 0u;
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

// What of a search a thread does, where a team shares it: of `across` times `across` rows of cells one, and of that one of so many parts.
struct Portion {
    y: i32,
    z: i32,
    across: i32,
    part: u32,
    parts: u32,
}

const ALL_OF_IT = Portion(0, 0, 1, 0u, 1u);
// Most long movers see some 8 times 8 rows, of dozens of objects each.
const TEAM_ACROSS: u32 = 4u;
const TEAM_PARTS: u32 = 16u;

// That of a thread of a workgroup of 256.
fn portion_of(local: u32) -> Portion {
    let row = local / TEAM_PARTS;
    return Portion(i32(row % TEAM_ACROSS), i32(row / TEAM_ACROSS), i32(TEAM_ACROSS), local % TEAM_PARTS, TEAM_PARTS);
}

// What of a span is a thread's.
fn share_of_span(span: Span, portion: Portion) -> Span {
    if portion.parts == 1u {
        return span;
    }
    let size = (span.count + portion.parts - 1u) / portion.parts;
    let begin = min(portion.part * size, span.count);
    let first = span.first + begin;
    return Span(first - select(0u, objects(), first >= objects()), min(size, span.count - begin));
}

// What a mover looks around with. Rounding of centres, which grows with the distance from the origin, must not lose a pair that
// AABBs decide on.
struct Probe {
    centre: vec3f,
    reach: vec3f,
    // Radius of the ball that a sphere's AABB encloses, half its size.
    ball: f32,
    is_sphere: bool,
}

fn probe_of(mover: u32, own: Aabb) -> Probe {
    let centre = 0.5 * own.min + 0.5 * own.max;
    let reach = 0.500002 * (own.max - own.min) + 1e-6 * abs(centre);
    let ball = max(max(reach.x, reach.y), reach.z);
    is_remote = !(ball < REMOTE);
    return Probe(centre, reach, ball, mover < step.spheres);
}

// A cube about a ball of radius 1 is in one of this radius.
const CORNER: f32 = 1.7320509;

// 1 where a sorted object is not known to be far: of two spheres, where the balls meet. What has no bounds has no centre, and is
// far from nothing. The AABBs themselves have the last word, later.
fn is_close(probe: Probe, other: vec4f) -> u32 {
    let apart = other.xyz - probe.centre;
    let touching = probe.ball + abs(other.w);
    let squared = dot(apart, apart);
    if RODS {
        let boxes_apart = any(abs(apart) > probe.reach + vec3f(abs(other.w)));
        return select(1u, 0u, boxes_apart | ((squared > touching * touching) & (other.w >= 0.0) & probe.is_sphere));
    }
    // Of spheres and few others a ball about the cube will do: this is where most of the time goes.
    let enough = touching * select(CORNER, 1.0, other.w >= 0.0);
    return select(1u, 0u, squared > enough * enough);
}

// Which of up to 32 sorted objects are close. Four at a time, so that memory is asked for all of them at once: `extents` has three
// rows to spare.
fn close_in(probe: Probe, first: u32, count: u32) -> u32 {
    var close = 0u;
    for (var k = 0u; k < count; k += 4u) {
        let a = extents[first + k];
        let b = extents[first + k + 1u];
        let c = extents[first + k + 2u];
        let d = extents[first + k + 3u];
        close |= (is_close(probe, a) | is_close(probe, b) << 1u | is_close(probe, c) << 2u | is_close(probe, d) << 3u) << k;
    }
    return close & (0xffffffffu >> (32u - count));
}

// Emits what is close in a span. Neighbouring threads find at different times, and what a find makes one of them do all wait for:
// so they look first, and then go through what they found together.
fn test_span(mover: u32, probe: Probe, span: Span) {
    var first = span.first;
    var left = span.count;
    while left > 0u {
        first = select(first, 0u, first == objects());
        let count = min(min(left, 32u), objects() - first);
        for (var rest = close_in(probe, first, count); rest != 0u; rest &= rest - 1u) {
            emit(mover, first + firstTrailingBit(rest));
        }
        first += count;
        left -= count;
    }
}

fn emit_neighbours(mover: u32, portion: Portion) {
    let own = aabbs[mover];
    let probe = probe_of(mover, own);
    let thread = u32(portion.y + portion.z * portion.across) * portion.parts + portion.part;
    let threads = u32(portion.across * portion.across) * portion.parts;
    if statics_stand_apart() {
        for (var id = step.spheres + step.rods + thread; id < objects(); id += threads) {
            if aabbs_meet(own, aabbs[id]) {
                emit(mover, id | AN_ID);
            }
        }
    }
    var all_of_them = false;
    var levels = cells[0];
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        if covers_too_much(cells_around(own, level)) {
            let beyond = is_beyond(own, level);
            levels &= ~select(0u, 1u << level, beyond);
            all_of_them |= !beyond;
        }
    }
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        var y = range.low.y + portion.y;
        var z = range.low.z + portion.z;
        var next = 32u * thread;
        while select((y <= range.high.y) & (z <= range.high.z), next < objects(), all_of_them) {
            var span = Span(next, min(32u, objects() - next));
            if !all_of_them {
                span = share_of_span(span_of_row(range, y, z, level), portion);
            }
            test_span(mover, probe, span);
            next += 32u * threads;
            y += portion.across;
            if y > range.high.y {
                y = range.low.y + portion.y;
                z += portion.across;
            }
        }
        if all_of_them {
            return;
        }
    }
}
