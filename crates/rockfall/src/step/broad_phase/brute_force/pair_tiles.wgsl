// requires model/step.wgsl step/broad_phase/meet.wgsl

// The tiled N² test (thesis section 2.5.1). The stage that uses it defines `emit`, which handles an entry.

var<workgroup> tile: array<Aabb, WORKGROUP>;

// Emits the entries of a mover in ascending order of id, then feature, and returns their number. All threads of the workgroup
// must call it. Threads after the last mover only help to load tiles.
fn emit_pairs(mover: u32, local: u32) -> u32 {
    let movers = step.spheres + step.rods;
    var own: Aabb;
    if mover < movers {
        own = aabbs[mover];
    }
    var count = 0u;
    for (var base = 0u; base < objects(); base += WORKGROUP) {
        workgroupBarrier();
        if base + local < objects() {
            tile[local] = aabbs[base + local];
        }
        workgroupBarrier();
        if mover < movers {
            let end = min(WORKGROUP, objects() - base);
            for (var k = 0u; k < end; k++) {
                if !(aabbs_meet(own, tile[k]) & (own.id != tile[k].id)) {
                    continue;
                }
                let id = base + k;
                let features = entries_of(mover, id);
                for (var feature = 0u; feature < features; feature++) {
                    emit(mover, count, id | (feature << ENTRY_ID_BITS));
                    count += 1u;
                }
            }
        }
    }
    return count;
}
