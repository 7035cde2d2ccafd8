// requires model/step.wgsl physics/period.wgsl physics/rigid_parts.wgsl

// The test of every broad phase: whether two objects may meet, and how many list entries they make.

// Returns whether two AABBs overlap (touching counts) and the groups, the low 16 bits of the tags, are equal.
// In periodic scenes, the nearest image of the second one counts.
fn aabbs_meet(a: Aabb, b: Aabb) -> bool {
    var way = vec3f(0.0);
    if PERIODIC {
        way = way_of(whole_periods(0.5 * b.min + 0.5 * b.max - (0.5 * a.min + 0.5 * a.max)));
    }
    return all(a.min <= b.max - way) & all(b.min - way <= a.max) & (((a.tag ^ b.tag) & 0xffffu) == 0u);
}

// Returns the number of entries that a polygon makes in the list of a rod (docs/physics section 2.19).
fn entries_of_polygon(index: u32) -> u32 {
    let surface = topology[step.polygons_at + index * POLYGON_WORDS + 9u];
    if surface <= SURFACE_TRIANGLE {
        return select(4u, 3u, surface == SURFACE_TRIANGLE);
    }
    return u32((surface == SURFACE_CONE) | (surface == SURFACE_BALL));
}

// Returns the number of entries that an object makes in the list of a mover. A box makes one for each feature in the list of
// a rod, and so does a polygon. Parts of one rigid body make none.
fn entries_of(mover: u32, id: u32) -> u32 {
    if never_meet(mover, id) {
        return 0u;
    }
    let movers = step.spheres + step.rods;
    if !(RODS & (mover >= step.spheres)) | (id < movers) {
        return 1u;
    }
    if ROD_POLYGONS {
        if id >= movers + step.boxes {
            return entries_of_polygon(id - movers - step.boxes);
        }
    }
    return BOX_FEATURES;
}
