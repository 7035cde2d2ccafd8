//! Rays.

use glam::Vec3;

use crate::rigid::collide::place;
use crate::rigid::shape::Shape;

/// The most steps. Flat surfaces need a few, round ones about five more.
const MOST_STEPS: usize = 64;

impl Shape {
    /// Where a ray first meets the shape, in lengths of `direction`: 0 from inside, `None` if it misses.
    ///
    /// The distance from a convex shape is a convex function along the ray. So Newton's method never passes the place where it
    /// is 0, and a ray that moves away again has missed.
    pub(crate) fn ray(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let mut part = 0.0;
        for _ in 0..MOST_STEPS {
            let point = origin + direction * part;
            let found = place(self, point)?;
            if found.distance <= 1e-6 * point.abs().max_element() {
                break;
            }
            let approach = -found.normal.dot(direction);
            if approach <= 0.0 {
                return None;
            }
            let next = part + found.distance / approach;
            if !next.is_finite() {
                return None;
            }
            if next == part {
                break;
            }
            part = next;
        }
        Some(part)
    }
}
