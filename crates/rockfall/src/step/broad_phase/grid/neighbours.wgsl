// requires model/step.wgsl physics/period.wgsl step/broad_phase/grid/cells.wgsl step/broad_phase/meet.wgsl

// Searches the cells around a mover for all objects that it may meet. The stage that uses it defines `emit`, which handles an
// object. The objects come in any order, as places among the sorted objects or as marked ids. An object may come twice. The
// mover itself and some objects that it does not meet come too.
//
// Shader compilers inline every function, so the loops are nested as little as possible, and the large functions are called
// from one place each.

// A range of sorted objects: the first one, and their number. After the last sorted object the span continues with the first
// one, because a row may wrap around the end of the table.
struct Span {
    first: u32,
    count: u32,
}

// The cells on a level in which the centre of an overlapping object may lie.
struct CellRange {
    low: vec3i,
    high: vec3i,
}

// Returns how far outside an AABB the centre of an overlapping object on a level may lie: half the largest edge, and a little
// more to cover rounding.
fn slack_around(own: Aabb, level: u32) -> vec3f {
    return 0.5005 * bitcast<f32>(cells[EDGES_AT + level]) + 1e-6 * max(abs(own.min), abs(own.max));
}

fn cells_around(own: Aabb, level: u32) -> CellRange {
    let slack = slack_around(own, level);
    return CellRange(cell_coordinates(own.min - slack, level), cell_coordinates(own.max + slack, level));
}

// Returns whether all objects on a level are so near the origin that an AABB cannot overlap them. Without this test a single
// body that flies off very fast would have too many cells to search.
fn is_beyond(own: Aabb, level: u32) -> bool {
    let slack = slack_around(own, level);
    let far = vec3f(bitcast<f32>(cells[FARTHEST_AT + level]));
    return any(own.min - slack > far) | any(own.max + slack < -far);
}

// Returns whether a range has more rows of cells than there are objects, or at least as many cells as the table. The counts
// are floats, because their product may be very large.
fn covers_too_much(range: CellRange) -> bool {
    let size = vec3f(range.high) - vec3f(range.low) + 1.0;
    return (size.y * size.z > f32(objects())) | (size.x * size.y * size.z >= f32(step.cells));
}

// Returns the sorted objects in a row of cells.
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

// The bit that marks an id where the other values are places of sorted objects.
const ID_MARK: u32 = 0x80000000u;

// Returns the id of the object at a place, or the id itself if it is marked. It has no branch, so that the loads of several
// calls overlap. The load is valid for a marked id too, because every id is a valid place.
fn id_at(place: u32) -> u32 {
    let bare = place & ~ID_MARK;
    return select(cells[step.sorted_at + bare], bare, (place & ID_MARK) != 0u);
}

// A mover whose probe has a `ball` of at least this radius is remote. The radius grows with the distance from the origin,
// because it allows for the rounding of centres. Squares of distances may overflow for a remote mover, so that every object
// is found. The AABBs then decide for pairs of spheres too.
const REMOTE_REACH: f32 = 1e12;

// Whether the searching mover is remote.
var<private> is_remote: bool;

fn may_meet(a: u32, b: u32) -> bool {
    // The search does not find pairs of spheres whose balls are apart.
    if (a < step.spheres) & (b < step.spheres) & !is_remote {
        if (step.flags & FLAG_GROUPS) == 0u {
            return true;
        }
        return ((topology[step.tags_at + a] ^ topology[step.tags_at + b]) & 0xffffu) == 0u;
    }
    return aabbs_meet(aabbs[a], aabbs[b]);
}

// Returns the number of entries that a found object makes in the list of a mover. The mover itself makes none. If boxes and
// polygons are few, one that was found in a cell makes none, because they are tested one by one.
fn entries_found(mover: u32, place: u32) -> u32 {
    let id = id_at(place);
    let is_tested_apart = ((place & ID_MARK) == 0u) & (id >= step.spheres + step.rods) & are_statics_tested_apart();
    if (id == mover) | is_tested_apart {
        return 0u;
    }
    if !may_meet(mover, id) {
        return 0u;
    }
    return entries_of(mover, id);
}

// The share of a thread in a search that a workgroup shares: one of every `across` times `across` rows of cells, and one of
// `parts` parts of that row.
struct Portion {
    // The row among `across` times `across` rows.
    y: i32,
    z: i32,
    across: i32,
    // The part of the row.
    part: u32,
    parts: u32,
}

const WHOLE_SEARCH = Portion(0, 0, 1, 0u, 1u);
// How a workgroup shares a search. Most long movers search about 8 times 8 rows, with dozens of objects each.
const GROUP_ACROSS: u32 = 4u;
const GROUP_PARTS: u32 = 16u;

// Returns the portion of a thread in a workgroup of 256 threads.
fn portion_of_thread(local: u32) -> Portion {
    let row = local / GROUP_PARTS;
    return Portion(i32(row % GROUP_ACROSS), i32(row / GROUP_ACROSS), i32(GROUP_ACROSS), local % GROUP_PARTS, GROUP_PARTS);
}

// Returns the part of a span that belongs to a portion.
fn share_of_span(span: Span, portion: Portion) -> Span {
    if portion.parts == 1u {
        return span;
    }
    let size = (span.count + portion.parts - 1u) / portion.parts;
    let begin = min(portion.part * size, span.count);
    let first = span.first + begin;
    return Span(first - select(0u, objects(), first >= objects()), min(size, span.count - begin));
}

// The AABB of the searching mover, as its centre and half its size. The size is enlarged to allow for the rounding of
// centres, which grows with the distance from the origin. So no pair is lost whose AABBs overlap.
struct Probe {
    centre: vec3f,
    // Half the size along each axis.
    reach: vec3f,
    // The greatest component of `reach`. For a sphere it is the radius of the ball that its AABB encloses.
    ball: f32,
    is_sphere: bool,
}

fn probe_of(mover: u32, own: Aabb) -> Probe {
    let centre = 0.5 * own.min + 0.5 * own.max;
    let reach = 0.500002 * (own.max - own.min) + 1e-6 * abs(centre);
    let ball = max(max(reach.x, reach.y), reach.z);
    is_remote = !(ball < REMOTE_REACH);
    return Probe(centre, reach, ball, mover < step.spheres);
}

// The cube around a ball of radius 1 fits into a ball of this radius, the square root of 3.
const CUBE_TO_BALL: f32 = 1.7320509;

// Returns 1 if a sorted object may overlap the mover, else 0. For two spheres it is 1 if their balls meet. An object without
// bounds has no centre, and the result is 1. The AABBs themselves decide later.
fn is_close(probe: Probe, other: vec4f) -> u32 {
    let apart = other.xyz - probe.centre;
    let touching = probe.ball + abs(other.w);
    let squared = dot(apart, apart);
    if RODS {
        let boxes_apart = any(abs(apart) > probe.reach + vec3f(abs(other.w)));
        return select(1u, 0u, boxes_apart | ((squared > touching * touching) & (other.w >= 0.0) & probe.is_sphere));
    }
    // Without rods nearly all objects are spheres. For other objects, a ball around the cube is accurate enough. Most of the
    // time of the search is spent here.
    let enough = touching * select(CUBE_TO_BALL, 1.0, other.w >= 0.0);
    return select(1u, 0u, squared > enough * enough);
}

// Returns a mask of the objects that are close, among up to 32 sorted objects. Four are loaded at a time, so that their loads
// overlap. For that `extents` has three rows of padding at the end.
fn close_in(probe: Probe, first: u32, count: u32) -> u32 {
    var close = 0u;
    for (var k = 0u; k < count; k += 4u) {
        let a = extents[first + k];
        let b = extents[first + k + 1u];
        let c = extents[first + k + 2u];
        let d = extents[first + k + 3u];
        close |= (is_close(probe, a) | (is_close(probe, b) << 1u) | (is_close(probe, c) << 2u) | (is_close(probe, d) << 3u)) << k;
    }
    return close & (0xffffffffu >> (32u - count));
}

// Whether a sorted rod, box or polygon does not meet the mover, although its cube may. The cube of a plate is far larger than the plate:
// every mover in a drum is in the cubes of all its walls.
fn is_long_apart(mover: u32, place: u32) -> bool {
    if !RODS & are_statics_tested_apart() {
        return false;
    }
    if extents[place].w >= 0.0 {
        return false;
    }
    return !aabbs_meet(aabbs[mover], aabbs[id_at(place)]);
}

// Emits the objects of a span that are close. Neighbouring threads find objects at different times, and all of them wait
// while one handles its object. So each thread first tests up to 32 objects, and then handles those that are close.
fn test_span(mover: u32, probe: Probe, span: Span) {
    var first = span.first;
    var left = span.count;
    while left > 0u {
        first = select(first, 0u, first == objects());
        let count = min(min(left, 32u), objects() - first);
        for (var rest = close_in(probe, first, count); rest != 0u; rest &= rest - 1u) {
            let place = first + firstTrailingBit(rest);
            if !is_long_apart(mover, place) {
                emit(mover, place);
            }
        }
        first += count;
        left -= count;
    }
}

// Number of images of a mover that search the cells: those displaced by one period or none along each axis.
const IMAGES: u32 = select(1u, 27u, PERIODIC);

// An image of an AABB in the box of a periodic scene. The one in the middle is the AABB itself.
fn image_of(own: Aabb, image: u32) -> Aabb {
    if !PERIODIC {
        return own;
    }
    let turns = vec3f(vec3u(image, image / 3u, image / 9u) % vec3u(3u)) - vec3f(1.0);
    let way = way_of(turns);
    return Aabb(own.min + way, own.id, own.max + way, own.tag);
}

// Whether an image may meet objects whose centres are in the box. Along axes without a period there is one image.
fn is_image_in_box(own: Aabb, image: u32) -> bool {
    if !PERIODIC {
        return true;
    }
    var edge = 0.0;
    for (var level = 0u; level < LEVELS; level++) {
        edge = max(edge, bitcast<f32>(cells[EDGES_AT + level]));
    }
    let from_ = vec3f(step.from_x, step.from_y, step.from_z);
    let length = periods();
    let is_displaced = (vec3u(image, image / 3u, image / 9u) % vec3u(3u)) != vec3u(1u);
    let is_beyond = (own.max + edge < from_) | (own.min - edge > from_ + length);
    return !any((length > vec3f(0.0)) & is_beyond) & !any((length <= vec3f(0.0)) & is_displaced);
}

// Emits all objects that a mover may meet, or those in the portion of a thread.
fn emit_neighbours(mover: u32, portion: Portion) {
    emit_statics(mover, portion);
    for (var image = 0u; image < IMAGES; image++) {
        let own = image_of(aabbs[mover], image);
        if is_image_in_box(own, image) {
            search_cells(mover, own, portion);
        }
    }
}

fn thread_of(portion: Portion) -> u32 {
    return u32(portion.y + portion.z * portion.across) * portion.parts + portion.part;
}

fn threads_of(portion: Portion) -> u32 {
    return u32(portion.across * portion.across) * portion.parts;
}

// Emits boxes and polygons that are so few that every mover tests them.
fn emit_statics(mover: u32, portion: Portion) {
    if are_statics_tested_apart() {
        for (var id = step.spheres + step.rods + thread_of(portion); id < objects(); id += threads_of(portion)) {
            if aabbs_meet(aabbs[mover], aabbs[id]) {
                emit(mover, id | ID_MARK);
            }
        }
    }
}

// Emits the objects in the cells around an AABB of a mover.
fn search_cells(mover: u32, own: Aabb, portion: Portion) {
    let probe = probe_of(mover, own);
    let thread = thread_of(portion);
    let threads = threads_of(portion);
    // Whether all sorted objects are tested, because the AABB covers too many cells.
    var tests_all = false;
    var levels = cells[MASK_AT];
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        if covers_too_much(cells_around(own, level)) {
            let beyond = is_beyond(own, level);
            levels &= ~select(0u, rest & (~rest + 1u), beyond);
            tests_all |= !beyond;
        }
    }
    for (var rest = levels; rest != 0u; rest &= rest - 1u) {
        let level = firstTrailingBit(rest);
        let range = cells_around(own, level);
        var y = range.low.y + portion.y;
        var z = range.low.z + portion.z;
        var next = 32u * thread;
        while select((y <= range.high.y) & (z <= range.high.z), next < objects(), tests_all) {
            var span = Span(next, min(32u, objects() - next));
            if !tests_all {
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
        if tests_all {
            return;
        }
    }
}
