// requires model/step.wgsl

// What every broad phase asks: may two objects meet, and which entries does that make?

// AABBs overlap (touching counts) and groups are equal.
fn aabbs_meet(a: Aabb, b: Aabb) -> bool {
    return all(a.min <= b.max) & all(b.min <= a.max) & (((a.tag ^ b.tag) & 0xffffu) == 0u);
}

// Entries that an object makes in the list of a mover: a rod has one for each feature of a box, and none for a polygon,
// which its end spheres meet.
fn entries_of(mover: u32, id: u32) -> u32 {
    let movers = step.spheres + step.rods;
    if !(RODS & (mover >= step.spheres)) | (id < movers) {
        return 1u;
    }
    return select(0u, BOX_FEATURES, id < movers + step.boxes);
}
