// requires model/step.wgsl step/broad_phase/meet.wgsl step/broad_phase/sort_and_skip/axis.wgsl

// The tiled test, with blocks skipped that cannot meet (thesis section 2.5.1, its proposal). A stage that uses it says in
// `emit` what becomes of an object.

var<workgroup> tile: array<Aabb, WORKGROUP>;

// Emits the entries of the mover in a place of the order, in any order. All threads of a workgroup must come here.
fn emit_near(block: u32, local: u32) {
    let movers = step.spheres + step.rods;
    let interval = extents[min(block, blocks() - 1u)].xy;
    let place = block * WORKGROUP + local;
    var own: Aabb;
    own.id = NONE;
    if place < objects() {
        own = aabbs[cells[step.sorted_at + place]];
    }
    for (var other = 0u; other < blocks(); other++) {
        // The same for the whole workgroup.
        let their = extents[other].xy;
        if (their.x > interval.y) | (interval.x > their.y) {
            continue;
        }
        workgroupBarrier();
        let first = other * WORKGROUP;
        if first + local < objects() {
            tile[local] = aabbs[cells[step.sorted_at + first + local]];
        }
        workgroupBarrier();
        if own.id < movers {
            let end = min(WORKGROUP, objects() - first);
            for (var k = 0u; k < end; k++) {
                if aabbs_meet(own, tile[k]) & (own.id != tile[k].id) {
                    emit(own.id, tile[k].id, entries_of(own.id, tile[k].id));
                }
            }
        }
    }
}

fn mover_at(place: u32) -> u32 {
    if place < objects() {
        let id = cells[step.sorted_at + place];
        return select(NONE, id, id < step.spheres + step.rods);
    }
    return NONE;
}
