//! Broad phase: pairs of AABBs that overlap.

use glam::Vec3;

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

/// All pairs (a, b), a < b, of boxes that overlap and that `may_touch` allows, in ascending order. Boxes may be infinite.
pub(crate) fn pairs(boxes: &[Aabb], may_touch: impl Fn(usize, usize) -> bool + Sync) -> Vec<(u32, u32)> {
    let overlap = |a: &Aabb, b: &Aabb| a.min.cmple(b.max).all() && b.min.cmple(a.max).all();
    let count = boxes.len();
    let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    all.filter(|(a, b)| overlap(&boxes[*a], &boxes[*b]) && may_touch(*a, *b)).map(|(a, b)| (a as u32, b as u32)).collect()
}
