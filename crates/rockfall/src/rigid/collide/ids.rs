//! Ids of contact points. The two upper bits tell the kinds apart.

/// A vertex of the clipped polygon: whether b has the reference face, both faces, and the labels of the two edges that meet
/// there (below 64 each).
pub(super) fn clip(b_is_reference: bool, reference: usize, incident: usize, labels: (u8, u8)) -> u32 {
    let faces = (b_is_reference as u32) << 12 | (reference as u32) << 6 | incident as u32;
    1 << 30 | faces << 12 | (labels.0 as u32) << 6 | labels.1 as u32
}

/// An edge of a and one of b.
pub(super) fn edges(of_a: usize, of_b: usize) -> u32 {
    2 << 30 | (of_a as u32) << 12 | of_b as u32
}

/// A vertex of b.
pub(super) fn vertex(number: usize) -> u32 {
    3 << 30 | number as u32
}

/// The only point of a pair: nearest features.
pub(super) fn nearest(of_a: usize, of_b: usize) -> u32 {
    (of_a as u32) << 12 | of_b as u32
}
