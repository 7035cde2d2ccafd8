@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<u32>;
@group(0) @binding(6) var<storage, read> words: array<u32>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// So many objects are remembered and put in order by their thread; more are looked for again, and put in order in place.
const SHORT: u32 = 32u;

// What was found: places (see `id_at`); once in order, indices in order of addition. Not in workgroup memory, for that is taken
// from the cache, which matters more here; and short, for it is set to 0 first.
var<private> ids: array<u32, SHORT>;
// The longest list of each slice of the workgroup, and where the slice begins.
var<workgroup> longest: array<atomic<u32>, WORKGROUP / SLICE>;
var<workgroup> offsets: array<u32, WORKGROUP / SLICE>;

// Objects found; the first SHORT are remembered.
var<private> found: u32;
// Entries that they make, or may make.
var<private> entries: u32;
// First word of the list, once it has a place; 0 before.
var<private> into: u32;

fn emit(mover: u32, place: u32) {
    if into == 0u {
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
        lists[into + entries * SLICE] = entry_key(id_at(place), feature);
        entries += 1u;
    }
}

// Of the objects remembered, those that the mover meets, by their index in order of addition, ascending, each once.
fn order_short(mover: u32) {
    var kept = 0u;
    entries = 0u;
    for (var place = 0u; place < found; place++) {
        let id = id_at(ids[place]);
        let user = user_of(id);
        var at = kept;
        var before = NONE;
        while at > 0u {
            before = ids[at - 1u];
            if before <= user {
                break;
            }
            at -= 1u;
        }
        if (id == mover) | ((at > 0u) & (before == user)) {
            continue;
        }
        if !may_meet(mover, id) {
            continue;
        }
        for (var k = kept; k > at; k--) {
            ids[k] = ids[k - 1u];
        }
        ids[at] = user;
        kept += 1u;
        entries += entries_of(mover, id);
    }
    found = kept;
}

// Room for a slice as wide as its longest list. A step without room for all is void, and nothing is written past the end.
fn allot(slice: u32, words: u32) -> u32 {
    let offset = atomicAdd(&status.pairs_needed, words);
    lists[step.slices_at + slice] = offset;
    if offset + words > step.pair_capacity {
        atomicOr(&status.void, VOID_PAIRS);
    }
    if offset + words < offset {
        atomicOr(&status.void, VOID_COUNT);
    }
    return select(offset, NONE, (offset + words > step.pair_capacity) | (offset + words < offset));
}

// Writes a list that is in order already.
fn write_short(mover: u32) {
    var place = 0u;
    for (var k = 0u; k < found; k++) {
        let id = id_of(ids[k]);
        let count = entries_of(mover, id);
        for (var feature = 0u; feature < count; feature++) {
            lists[into + place * SLICE] = id | feature << ENTRY_ID_BITS;
            place += 1u;
        }
    }
    lists[mover] = place;
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
            lists[mover] = 0u;
        } else {
            // `count_long` has counted them, and `fill_long` will write them.
            entries = lists[mover];
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
                offsets[slice] = allot(mover / SLICE, atomicLoad(&longest[slice]) * SLICE);
            }
            workgroupBarrier();
            searches &= offsets[slice] != NONE;
            into = step.entries_at + offsets[slice] + local % SLICE;
            if searches & (found <= SHORT) {
                write_short(mover);
                searches = false;
            }
            entries = 0u;
        } else if searches {
            lists[mover] = order_long(into, entries);
        }
    }
}
