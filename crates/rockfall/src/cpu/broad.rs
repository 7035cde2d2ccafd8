//! The broad phase's question, asked of one mover: what may it meet?

use crate::layout::{Aabb, BOX_FEATURES, ENTRY_ID_BITS, Step};

/// The list entries of a mover, in ascending order of id, then feature.
pub(crate) fn for_each_pair(step: &Step, aabbs: &[Aabb], mover: u32, mut take: impl FnMut(u32)) {
    let own = &aabbs[mover as usize];
    let is_rod = mover >= step.spheres;
    let boxes = step.spheres + step.rods..step.spheres + step.rods + step.boxes;
    // A rod meets no polygon: its end spheres do.
    let others = if is_rod { boxes.end as usize } else { aabbs.len() };
    for (id, other) in (0..).zip(&aabbs[..others]) {
        if overlap(own, other) & (id != mover) & (own.tag & 0xffff == other.tag & 0xffff) {
            let features = if is_rod && boxes.contains(&id) { BOX_FEATURES } else { 1 };
            for feature in 0..features {
                take(feature << ENTRY_ID_BITS | id);
            }
        }
    }
}

/// Touching counts. Without branches, for the loop over all objects is the hottest one there is.
fn overlap(a: &Aabb, b: &Aabb) -> bool {
    let axis = |k: usize| (a.min[k] <= b.max[k]) & (b.min[k] <= a.max[k]);
    axis(0) & axis(1) & axis(2)
}
