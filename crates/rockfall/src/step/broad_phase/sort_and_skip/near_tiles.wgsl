// requires model/step.wgsl step/broad_phase/meet.wgsl step/broad_phase/sort_and_skip/axis.wgsl

// The tiled test that skips blocks that cannot meet (proposed in thesis section 2.5.1). The stage that uses it defines
// `emit`, which handles an object that a mover may meet.

var<workgroup> tile: array<Aabb, WORKGROUP>;

// Emits the objects that the mover of a thread may meet, in any order. The mover is sorted object `local` of the block. All
// threads of the workgroup must call it.
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
        // This condition is uniform across the workgroup.
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

// Returns the mover at a place among the sorted objects, or NONE if there is none.
fn mover_at(place: u32) -> u32 {
    if place < objects() {
        let id = cells[step.sorted_at + place];
        return select(NONE, id, id < step.spheres + step.rods);
    }
    return NONE;
}
