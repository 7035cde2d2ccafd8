@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> words: array<u32>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// So many objects are remembered and put in order by their thread; more are looked for again, and put in order in place.
const SHORT: u32 = 32u;
// Whether there are so many objects that a key has no room for the place beside the index: then ids are looked up.
override MANY: bool = false;
override PLACE_BITS: u32 = 5u * u32(!MANY);
override PLACE_MASK: u32 = (1u << PLACE_BITS) - 1u;

// What was found: places (see `id_at`), then ids; once in order, those that are kept. Not in workgroup memory, for that is taken from
// the cache, which matters more here; and short, for all of it is set to 0 first, which takes time.
var<private> ids: array<u32, SHORT>;
// The longest list of each slice of the workgroup, and where the slice begins.
var<workgroup> longest: array<atomic<u32>, WORKGROUP / SLICE>;
var<workgroup> offsets: array<u32, WORKGROUP / SLICE>;

// Objects found; the first SHORT are remembered.
var<private> found: u32;
// Entries that they make, or may make.
var<private> entries: u32;
// Slot of the first entry, once it has a place; row 0 before.
var<private> into: vec2u;

fn emit(mover: u32, place: u32) {
    if is_remote {
        if !may_meet(mover, id_at(place)) {
            return;
        }
    }
    if into.x == 0u {
        if found < SHORT {
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

// Index in order of addition and, but where there are MANY, which of the objects remembered it is; NONE where the mover does not meet it, or there is none.
fn key_of(mover: u32, place: u32) -> u32 {
    if place >= found {
        return NONE;
    }
    let id = id_at(ids[place]);
    ids[place] = id;
    if (id == mover) | !may_meet(mover, id) {
        return NONE;
    }
    return user_of(id) << PLACE_BITS | (place & PLACE_MASK);
}

fn four_keys(mover: u32, place: u32) -> vec4u {
    if place >= found {
        return vec4u(NONE);
    }
    return vec4u(key_of(mover, place), key_of(mover, place + 1u), key_of(mover, place + 2u), key_of(mover, place + 3u));
}

// Keys in their order, and the ids that they stand for.
struct Run {
    keys: Sixteen,
    ids: Sixteen,
}

fn ids_of(keys: vec4u) -> vec4u {
    if MANY {
        return vec4u(id_of(keys.x), id_of(keys.y), id_of(keys.z), id_of(keys.w));
    }
    return vec4u(ids[keys.x % SHORT], ids[keys.y % SHORT], ids[keys.z % SHORT], ids[keys.w % SHORT]);
}

fn run_of(keys: Sixteen) -> Run {
    return Run(keys, Sixteen(ids_of(keys.a), ids_of(keys.b), ids_of(keys.c), ids_of(keys.d)));
}

// How many ids are kept, and the index in order of addition of the last one.
var<private> kept: u32;
var<private> before: u32;

fn keep(mover: u32, key: u32, id: u32) {
    if (key != NONE) & ((key >> PLACE_BITS) != before) {
        before = key >> PLACE_BITS;
        ids[kept] = id;
        kept += 1u;
        entries += entries_of(mover, id);
    }
}

fn keep_4(mover: u32, keys: vec4u, four: vec4u) {
    keep(mover, keys.x, four.x);
    keep(mover, keys.y, four.y);
    keep(mover, keys.z, four.z);
    keep(mover, keys.w, four.w);
}

fn keep_run(mover: u32, run: Run) {
    keep_4(mover, run.keys.a, run.ids.a);
    keep_4(mover, run.keys.b, run.ids.b);
    keep_4(mover, run.keys.c, run.ids.c);
    keep_4(mover, run.keys.d, run.ids.d);
}

// Of the objects remembered, those that the mover meets, by their index in order of addition, ascending, each once.
fn order_short(mover: u32) {
    kept = 0u;
    before = NONE;
    entries = 0u;
    if found <= 4u {
        let keys = sorted_4(four_keys(mover, 0u));
        keep_4(mover, keys, ids_of(keys));
        found = kept;
        return;
    }
    var low = sorted_16(Sixteen(four_keys(mover, 0u), four_keys(mover, 4u), four_keys(mover, 8u), four_keys(mover, 12u)));
    if found > 16u {
        let rest = Sixteen(four_keys(mover, 16u), four_keys(mover, 20u), four_keys(mover, 24u), four_keys(mover, 28u));
        let high = run_of(merged(&low, sorted_16(rest)));
        keep_run(mover, run_of(low));
        keep_run(mover, high);
    } else {
        keep_run(mover, run_of(low));
    }
    found = kept;
}

// Room for a slice as wide as its longest list. A step without room for all is void, and nothing is written past the end.
fn allot(slice: u32, rows: u32) -> u32 {
    let offset = atomicAdd(&status.pair_rows_needed, rows);
    put_head(step.slices_at + slice, offset);
    if offset + rows > step.pair_rows {
        atomicOr(&status.void, VOID_PAIRS);
    }
    if offset + rows < offset {
        atomicOr(&status.void, VOID_COUNT);
    }
    return select(offset, NONE, (offset + rows > step.pair_rows) | (offset + rows < offset));
}

// Writes a list that is in order already.
fn write_short(mover: u32) {
    var place = 0u;
    for (var k = 0u; k < found; k++) {
        let id = ids[k];
        let count = entries_of(mover, id);
        for (var feature = 0u; feature < count; feature++) {
            lists[into.x + place][into.y] = id | feature << ENTRY_ID_BITS;
            place += 1u;
        }
    }
    put_head(mover, place);
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
        atomicStore(&status.rebuild, LISTS_MADE);
    }
    let slice = local / SLICE;
    if local < WORKGROUP / SLICE {
        atomicStore(&longest[local], 0u);
    }
    workgroupBarrier();
    // Round 0 finds and counts; round 1 finds again what was too much to remember.
    var searches = mover < step.spheres + step.rods;
    if searches {
        searches = !is_long(aabbs[mover]);
    }
    if mover < step.slices_at {
        if searches | (mover >= step.spheres + step.rods) {
            put_head(mover, 0u);
        } else {
            // `count_long` has counted them, and `fill_long` will write them.
            entries = head_of(mover);
        }
    }
    for (var round = 0u; round < 2u; round++) {
        if searches {
            emit_neighbours(mover, ALL_OF_IT);
        }
        if round == 0u {
            if searches & (found <= SHORT) {
                order_short(mover);
            }
            atomicMax(&longest[slice], entries);
            workgroupBarrier();
            if (local % SLICE == 0u) & (mover < step.slices_at) {
                offsets[slice] = allot(mover / SLICE, atomicLoad(&longest[slice]));
            }
            workgroupBarrier();
            searches &= offsets[slice] != NONE;
            into = vec2u(step.entries_at / SLICE + offsets[slice], local % SLICE);
            if searches & (found <= SHORT) {
                write_short(mover);
                searches = false;
            }
            entries = 0u;
        } else if searches {
            put_head(mover, order_long(into, entries));
        }
    }
}
