//! Differences that are only rounding errors (docs/physics section 2.3).

use glam::Vec3;

/// Relative size of a rounding error: a difference of vectors counts as 0 up to this times their length (docs/physics
/// section 2.3).
pub(crate) const ROUNDED: f32 = 5e-7;
/// A distance above this part of the distance at which a pair begins to touch never counts as a rounding error.
pub(crate) const SMALL: f32 = 0.01;

/// Returns a distance vector, and 0 where it is only a rounding error. `squared` is the squared length of the vectors that the
/// distance is a difference of. Where the distance is nearly 0, these vectors are no longer than the segments. `reach` is the
/// distance at which the pair begins to touch.
pub(crate) fn unrounded(d: Vec3, squared: f32, reach: f32) -> Vec3 {
    let rounded = (ROUNDED * ROUNDED * squared).min(SMALL * SMALL * reach * reach);
    if d.length_squared() <= rounded { Vec3::ZERO } else { d }
}

/// A parameter that is beyond an end by at most this belongs to the segment, so that rounding errors do not decide.
pub(crate) const AT_END: f32 = 1e-6;
