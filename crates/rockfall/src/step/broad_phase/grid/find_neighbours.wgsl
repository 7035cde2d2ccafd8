// requires model/lists.wgsl model/order.wgsl model/put_head.wgsl model/step.wgsl physics/escape.wgsl
// requires step/broad_phase/grid/cells.wgsl
// requires step/broad_phase/grid/neighbours.wgsl step/broad_phase/grid/sort.wgsl step/broad_phase/heap.wgsl
// requires physics/rigid_parts.wgsl step/broad_phase/meet.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// Objects in a run, which a sorting network sorts at once.
const RUN_SIZE: u32 = 32u;
// Runs of objects that a thread remembers: two in scenes with rods, which have many neighbours, three in scenes with large
// spheres, which press small ones together, one in others. A mover that finds more objects repeats its search, and sorts its
// list in place.
const RUNS: u32 = select(1u + u32(RODS), 3u, LARGE);
const REMEMBERED: u32 = RUNS * RUN_SIZE;
// Whether there are so many objects that a key has no room for the place in the run beside the insertion index. Ids are then
// looked up by insertion index.
override MANY: bool = false;
override PLACE_BITS: u32 = 5u * u32(!MANY);
override PLACE_MASK: u32 = (1u << PLACE_BITS) - 1u;

// The objects found: first their places (see `id_at`), then their ids, and after sorting the ids that are kept. The array is
// not in workgroup memory, which would take space from the first-level cache. It is short, because setting all of it to 0 at
// the start takes time.
var<private> ids: array<u32, REMEMBERED>;
// For each slice of the workgroup: the length of its longest list, and the row in which the slice begins.
var<workgroup> longest: array<atomic<u32>, WORKGROUP / SLICE>;
var<workgroup> offsets: array<u32, WORKGROUP / SLICE>;

// Number of objects found. The first REMEMBERED of them are remembered.
var<private> found: u32;
// In the first search: an upper bound of the number of entries. In the second: the number of keys written.
var<private> entries: u32;
// Slot of the first entry. Its row is 0 until the slice is allocated.
var<private> into: vec2u;

// Handles an object that `emit_neighbours` finds. The first search remembers it, the second writes its keys to the list.
fn emit(mover: u32, place: u32) {
    if is_remote {
        if !may_meet(mover, id_at(place)) {
            return;
        }
    }
    if into.x == 0u {
        if found < REMEMBERED {
            ids[found] = place;
        }
        found += 1u;
        if RODS & (mover >= step.spheres) {
            entries += entries_of(mover, id_at(place));
        } else {
            entries += 1u;
        }
        return;
    }
    let count = entries_found(mover, place);
    for (var feature = 0u; feature < count; feature++) {
        lists[into.x + entries][into.y] = entry_key(id_at(place), feature);
        entries += 1u;
    }
}

// The current run: where it begins in `ids`, and the number of its objects.
var<private> run_at: u32;
var<private> in_run: u32;
// The mover's AABB, in scenes with rods.
var<private> own_aabb: Aabb;

// Returns the sort key of an object of the run: its insertion index and, unless there are MANY objects, its place in the run.
// Returns NONE if the mover does not meet the object, or if the place is after the end of the run. It has few branches, so
// that the loads of several objects overlap. Loads after the end of the run are valid: `ids` holds an earlier value or 0
// there.
fn key_of(mover: u32, place: u32) -> u32 {
    let id = id_at(ids[run_at + place]);
    ids[run_at + place] = id;
    let key = (insertion_index(id) << PLACE_BITS) | (place & PLACE_MASK);
    let is_other = (place < in_run) & (id != mover);
    if RIGID_BODIES {
        if is_other & never_meet(mover, id) {
            return NONE;
        }
    }
    if RODS {
        return select(NONE, key, is_other & aabbs_meet(own_aabb, aabbs[id]));
    }
    if !is_other | !may_meet(mover, id) {
        return NONE;
    }
    return key;
}

fn four_keys(mover: u32, place: u32) -> vec4u {
    if place >= in_run {
        return vec4u(NONE);
    }
    return vec4u(key_of(mover, place), key_of(mover, place + 1u), key_of(mover, place + 2u), key_of(mover, place + 3u));
}

fn run_id(key: u32) -> u32 {
    return ids[run_at + key % RUN_SIZE];
}

// Sorted keys, and their ids.
struct Run {
    keys: Sixteen,
    ids: Sixteen,
}

fn ids_of(keys: vec4u) -> vec4u {
    if MANY {
        return vec4u(id_of(keys.x), id_of(keys.y), id_of(keys.z), id_of(keys.w));
    }
    return vec4u(run_id(keys.x), run_id(keys.y), run_id(keys.z), run_id(keys.w));
}

fn run_of(keys: Sixteen) -> Run {
    return Run(keys, Sixteen(ids_of(keys.a), ids_of(keys.b), ids_of(keys.c), ids_of(keys.d)));
}

// Number of ids that are kept, and the insertion index of the last one.
var<private> kept: u32;
var<private> before: u32;

// Keeps an id, unless its key is NONE or a duplicate of the last one.
fn keep(key: u32, id: u32) {
    if (key != NONE) & ((key >> PLACE_BITS) != before) {
        before = key >> PLACE_BITS;
        ids[run_at + kept] = id;
        kept += 1u;
    }
}

fn keep_4(keys: vec4u, four: vec4u) {
    keep(keys.x, four.x);
    keep(keys.y, four.y);
    keep(keys.z, four.z);
    keep(keys.w, four.w);
}

fn keep_run(run: Run) {
    keep_4(run.keys.a, run.ids.a);
    keep_4(run.keys.b, run.ids.b);
    keep_4(run.keys.c, run.ids.c);
    keep_4(run.keys.d, run.ids.d);
}

// Replaces the current run by the ids that the mover meets, in ascending order of insertion index, without duplicates.
fn order_run(mover: u32) {
    kept = 0u;
    before = NONE;
    if in_run <= 4u {
        let keys = sorted_4(four_keys(mover, 0u));
        keep_4(keys, ids_of(keys));
        return;
    }
    var low = sorted_16(Sixteen(four_keys(mover, 0u), four_keys(mover, 4u), four_keys(mover, 8u), four_keys(mover, 12u)));
    if in_run > 16u {
        let rest = Sixteen(four_keys(mover, 16u), four_keys(mover, 20u), four_keys(mover, 24u), four_keys(mover, 28u));
        let high = run_of(merged(&low, sorted_16(rest)));
        keep_run(run_of(low));
        keep_run(high);
    } else {
        keep_run(run_of(low));
    }
}

// Returns the number of entries that the kept ids of the run make.
fn entries_of_run(mover: u32) -> u32 {
    var sum = kept;
    if RODS & (mover >= step.spheres) {
        sum = 0u;
        for (var k = 0u; k < kept; k++) {
            sum += entries_of(mover, ids[run_at + k]);
        }
    }
    return sum;
}

// Number of sorted ids that are kept in each run.
var<private> kept_in_run: vec4u;

// Sorts each run that has objects, and counts the entries.
fn order_runs(mover: u32) {
    if RODS {
        own_aabb = aabbs[mover];
    }
    entries = 0u;
    for (var k = 0u; k < RUNS; k++) {
        run_at = k * RUN_SIZE;
        in_run = min(found - min(found, run_at), RUN_SIZE);
        if (k == 0u) | (in_run > 0u) {
            order_run(mover);
            kept_in_run[k] = kept;
            entries += entries_of_run(mover);
        }
    }
    // Which run an object is in that was found twice depends on the order of the objects of a cell, and the count must not.
    if (RUNS > 1u) & (found > RUN_SIZE) {
        entries = merge_runs(mover, false);
    }
}

// Allocates rows for a slice, as many as its longest list has entries. Returns the first row, or NONE if the rows do not fit.
// In that case the step is rejected, and nothing is written past the end.
fn allocate_rows(slice: u32, rows: u32) -> u32 {
    let offset = atomicAdd(&status.pair_rows_needed, rows);
    put_head(step.slices_at + slice, offset);
    if offset + rows > step.pair_rows {
        atomicOr(&status.rejected, REJECTED_PAIRS);
    }
    if offset + rows < offset {
        atomicOr(&status.rejected, REJECTED_COUNT);
    }
    return select(offset, NONE, (offset + rows > step.pair_rows) | (offset + rows < offset));
}

// Returns the insertion index of the next object of a run after `taken` objects, or NONE if there is none.
fn head_of_run(run: u32, taken: u32) -> u32 {
    let id = ids[run * RUN_SIZE + min(taken, RUN_SIZE - 1u)];
    return select(NONE, insertion_index(id), taken < kept_in_run[run]);
}

// Writes the sorted runs to the list.
fn write_runs(mover: u32) {
    var place = 0u;
    if RUNS == 1u {
        for (; place < kept_in_run.x; place++) {
            lists[into.x + place][into.y] = ids[place];
        }
    } else {
        place = merge_runs(mover, true);
    }
    put_head(mover, place);
}

// Merges the sorted runs, and writes the list if `writes` is set. Returns the number of entries. An object may be in several runs.
fn merge_runs(mover: u32, writes: bool) -> u32 {
    var place = 0u;
    var taken = vec4u(0u);
    var heads = vec4u(NONE);
    for (var run = 0u; run < RUNS; run++) {
        heads[run] = head_of_run(run, 0u);
    }
    loop {
        let least = min(min(heads.x, heads.y), min(heads.z, heads.w));
        if least == NONE {
            break;
        }
        var id = 0u;
        for (var run = 0u; run < RUNS; run++) {
            if heads[run] == least {
                id = ids[run * RUN_SIZE + taken[run]];
                taken[run] += 1u;
                heads[run] = head_of_run(run, taken[run]);
            }
        }
        let count = entries_of(mover, id);
        for (var feature = 0u; (feature < count) & writes; feature++) {
            lists[into.x + place + feature][into.y] = id | (feature << ENTRY_ID_BITS);
        }
        place += count;
    }
    return place;
}

@compute @workgroup_size(64)
fn find_neighbours(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if cells[1] == 0u {
        return;
    }
    let mover = linear_thread(group, groups, local);
    if mover == 0u {
        // Exact lists may be rebuilt a second time in a step.
        count_rebuild();
        atomicStore(&status.rebuild, REBUILD_DONE);
    }
    let slice = local / SLICE;
    if local < WORKGROUP / SLICE {
        atomicStore(&longest[local], 0u);
    }
    workgroupBarrier();
    // Round 0 finds the objects and counts the entries. Round 1 repeats the search of movers that found too many objects to
    // remember.
    var searches = mover < step.spheres + step.rods;
    if searches {
        searches = !is_long(aabbs[mover]);
    }
    if mover < step.slices_at {
        if searches | (mover >= step.spheres + step.rods) {
            put_head(mover, 0u);
        } else {
            // `count_long` has counted the entries of a long mover, and `fill_long` writes them.
            entries = head_of(mover);
        }
    }
    for (var round = 0u; round < 2u; round++) {
        if searches {
            emit_neighbours(mover, WHOLE_SEARCH);
        }
        if round == 0u {
            if searches & (found <= REMEMBERED) {
                order_runs(mover);
            }
            atomicMax(&longest[slice], entries);
            workgroupBarrier();
            if (local % SLICE == 0u) & (mover < step.slices_at) {
                offsets[slice] = allocate_rows(mover / SLICE, atomicLoad(&longest[slice]));
            }
            workgroupBarrier();
            searches &= offsets[slice] != NONE;
            into = vec2u(step.entries_at / SLICE + offsets[slice], local % SLICE);
            if searches & (found <= REMEMBERED) {
                write_runs(mover);
                searches = false;
            }
            entries = 0u;
        } else if searches {
            put_head(mover, heap_sort_list(into, entries));
        }
    }
}
