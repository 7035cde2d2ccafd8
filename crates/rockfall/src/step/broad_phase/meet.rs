//! The broad phase's question, asked of one mover: what may it meet?

use glam::Vec4;

use crate::model::layout::{BOX_FEATURES, ENTRY_BITS, FEATURE_BITS, WORKGROUP};
use crate::model::step::{Aabb, Step};

/// The list entries of a mover, in ascending order of id, then feature.
pub(crate) fn for_each_pair(step: &Step, aabbs: &[Aabb], mover: u32, mut take: impl FnMut(u32)) {
    let own = &aabbs[mover as usize];
    for (id, other) in (0..).zip(aabbs) {
        if may_meet(own, other) {
            entries(step, mover, id, &mut take);
        }
    }
}

/// The same in any order, of the blocks whose intervals in x meet the mover's own. `cells` holds the order that the blocks are
/// of, `intervals` one a block.
pub(crate) fn for_each_near(
    step: &Step,
    aabbs: &[Aabb],
    cells: &[u32],
    intervals: &[Vec4],
    mover: u32,
    mut take: impl FnMut(u32),
) {
    let own = &aabbs[mover as usize];
    let order = &cells[step.sorted_at as usize..][..aabbs.len()];
    for (block, interval) in order.chunks(WORKGROUP as usize).zip(intervals) {
        if interval.x > own.max[0] || own.min[0] > interval.y {
            continue;
        }
        for id in block {
            if may_meet(own, &aabbs[*id as usize]) {
                entries(step, mover, *id, &mut take);
            }
        }
    }
}

/// AABBs overlap (touching counts) and groups are equal. Without branches, for it is asked in the hottest of all loops.
pub(crate) fn may_meet(a: &Aabb, b: &Aabb) -> bool {
    let axis = |k: usize| (a.min[k] <= b.max[k]) & (b.min[k] <= a.max[k]);
    axis(0) & axis(1) & axis(2) & same_group(a, b)
}

/// Groups are the low 16 bits of the tags.
pub(crate) fn same_group(a: &Aabb, b: &Aabb) -> bool {
    a.tag & 0xffff == b.tag & 0xffff
}

/// The entries that a mover's list has for an object that it may meet: one for each feature of a box that a rod may touch,
/// none for itself, nor for a rod and a polygon, which the rod's end spheres meet.
pub(crate) fn entries(step: &Step, mover: u32, id: u32, mut take: impl FnMut(u32)) {
    let is_rod = mover >= step.spheres;
    let boxes = step.spheres + step.rods..step.spheres + step.rods + step.boxes;
    if id == mover || (is_rod && id >= boxes.end) {
        return;
    }
    let features = if is_rod && boxes.contains(&id) { BOX_FEATURES } else { 1 };
    for feature in 0..features {
        take(feature << (ENTRY_BITS - FEATURE_BITS) | id);
    }
}
