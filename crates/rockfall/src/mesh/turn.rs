//! Turns about an axis, exact for multiples of a quarter turn.

use glam::DVec3;

/// A turn about an axis through the origin.
pub(super) struct Turn {
    /// Unit vector.
    axis: DVec3,
    sin: f64,
    cos: f64,
}

impl Turn {
    /// `None` if the axis is 0, or if a number is not finite.
    pub(super) fn new(axis: DVec3, degrees: f64) -> Option<Self> {
        let scale = axis.abs().max_element();
        if !(axis.is_finite() && degrees.is_finite() && scale > 0.0) {
            return None;
        }
        // The division keeps the squares of the coordinates in range.
        let (sin, cos) = sin_cos(degrees % 360.0, 360.0);
        Some(Self { axis: (axis / scale).normalize(), sin, cos })
    }

    /// The turned position, by the formula of Rodrigues.
    pub(super) fn apply(&self, position: DVec3) -> DVec3 {
        let along = self.axis * self.axis.dot(position);
        position * self.cos + self.axis.cross(position) * self.sin + along * (1.0 - self.cos)
    }
}

/// Sine and cosine of an angle in the unit of which `whole` is a full turn. They are exact at multiples of a quarter turn.
pub(super) fn sin_cos(angle: f64, whole: f64) -> (f64, f64) {
    let quarter = 0.25 * whole;
    let quarters = (angle / quarter).round();
    let (sin, cos) = ((angle - quarters * quarter) / whole * std::f64::consts::TAU).sin_cos();
    match quarters.rem_euclid(4.0) as u32 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}
