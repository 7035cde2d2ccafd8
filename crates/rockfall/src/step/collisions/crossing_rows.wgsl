// requires model/step.wgsl

// The crossings that `find_crossings` wrote: for each sphere, in regions 0 and 2 of `crossings`, the changes of its position and
// velocity, each with one half of the id of the other object. An id is too large for one float, and as the bits of a float it may
// be denormal. The low half is negative where there is no crossing. ALONE is added to the high half where the other object does
// not move.

const ALONE: u32 = 65536u;

struct CrossingRow {
    // The other object of the crossing that counts for a sphere, or NONE.
    other: u32,
    is_alone: bool,
}

fn crossing_row(sphere: u32) -> CrossingRow {
    let low = crossings[sphere].w;
    if low < 0.0 {
        return CrossingRow(NONE, false);
    }
    let high = u32(crossings[2u * step.spheres + sphere].w);
    return CrossingRow(u32(low) | ((high % ALONE) << 16u), high >= ALONE);
}

// Whether an object is a sphere whose crossing is handled, because it counts for each of its moving spheres.
fn has_handled_crossing(id: u32) -> bool {
    if id >= step.spheres {
        return false;
    }
    let row = crossing_row(id);
    if (row.other == NONE) | row.is_alone {
        return row.is_alone;
    }
    return crossing_row(row.other).other == id;
}
