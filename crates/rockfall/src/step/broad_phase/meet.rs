//! The test of every broad phase, on the CPU: which objects a mover may meet, and which list entries they make.

use glam::Vec4;

use crate::model::layout::{BOX_FEATURES, ENTRY_BITS, FEATURE_BITS, WORKGROUP};
use crate::model::period::Periods;
use crate::model::step::Aabb;
use crate::model::view::{Object, View};
use crate::physics::rigid::never_meet;
use crate::physics::rod_polygon::features;

/// Calls `take` with each list entry of a mover, in ascending order of id, then feature.
pub(crate) fn for_each_pair(view: &View, aabbs: &[Aabb], mover: u32, mut take: impl FnMut(u32)) {
    let (own, periods) = (&aabbs[mover as usize], Periods::of(view.step));
    for (id, other) in (0..).zip(aabbs) {
        if may_meet(periods.as_ref(), own, other) {
            entries(view, mover, id, &mut take);
        }
    }
}

/// Calls `take` with each list entry of a mover, in any order. Only blocks whose interval in x meets that of the mover are
/// searched. `cells` holds the sorted objects, in blocks of `WORKGROUP`. `intervals` holds the interval of each block.
pub(crate) fn for_each_near(
    view: &View,
    aabbs: &[Aabb],
    cells: &[u32],
    intervals: &[Vec4],
    mover: u32,
    mut take: impl FnMut(u32),
) {
    let (own, periods) = (&aabbs[mover as usize], Periods::of(view.step));
    let order = &cells[view.step.layout.sorted_at as usize..][..aabbs.len()];
    for (block, interval) in order.chunks(WORKGROUP as usize).zip(intervals) {
        if interval.x > own.max[0] || own.min[0] > interval.y {
            continue;
        }
        for id in block {
            if may_meet(periods.as_ref(), own, &aabbs[*id as usize]) {
                entries(view, mover, *id, &mut take);
            }
        }
    }
}

/// Returns whether two AABBs overlap (touching counts) and the groups are equal. It has no branches, because it is called in
/// the hottest loop. In periodic scenes, the nearest image of the second one counts.
pub(crate) fn may_meet(periods: Option<&Periods>, a: &Aabb, b: &Aabb) -> bool {
    let image;
    let b = match periods {
        None => b,
        Some(periods) => {
            image = periods.near_aabb(a, b);
            &image
        }
    };
    let axis = |k: usize| (a.min[k] <= b.max[k]) & (b.min[k] <= a.max[k]);
    axis(0) & axis(1) & axis(2) & same_group(a, b)
}

/// Returns whether the groups, the low 16 bits of the tags, are equal.
pub(crate) fn same_group(a: &Aabb, b: &Aabb) -> bool {
    a.tag & 0xffff == b.tag & 0xffff
}

/// Calls `take` with each entry that an object makes in the list of a mover that may meet it. A box makes one entry for each
/// feature in the list of a rod, and so does a polygon. A mover makes none in its own list. Parts of one rigid body make none.
pub(crate) fn entries(view: &View, mover: u32, id: u32, mut take: impl FnMut(u32)) {
    let layout = &view.step.layout;
    let is_rod = mover >= layout.spheres;
    if id == mover || never_meet(view, mover, id) {
        return;
    }
    let features = match view.object(id) {
        Object::Cuboid(_) if is_rod => BOX_FEATURES,
        Object::Polygon(polygon) if is_rod => features(view.polygon(polygon).surface),
        _ => 1,
    };
    for feature in 0..features {
        take(feature << (ENTRY_BITS - FEATURE_BITS) | id);
    }
}
