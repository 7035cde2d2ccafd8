//! A grid of points.

use glam::DVec3;
use rockfall::{Error, Result};

/// Largest number of points.
const MOST: f64 = 1e8;

/// A regular grid of points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Grid {
    /// The first point, in units.
    pub origin: DVec3,
    /// Distance between neighbouring points, in units.
    pub spacing: f64,
    /// Number of points along x, y and z.
    pub counts: [usize; 3],
}

impl Grid {
    /// A grid from `low` to `high` or a little beyond it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a spacing that is not positive, and for a grid of more than 10^8 points.
    pub fn between(low: DVec3, high: DVec3, spacing: f64) -> Result<Self> {
        let refused = |value: String, expected: &'static str| Err(Error::Invalid { field: "spacing", value, expected });
        if !(spacing > 0.0 && spacing.is_finite()) {
            return refused(spacing.to_string(), "a finite number greater than 0");
        }
        let counts = ((high - low).max(DVec3::ZERO) / spacing).ceil() + 1.0;
        if counts.x * counts.y * counts.z > MOST {
            return refused(
                format!("{spacing} ({} x {} x {} points)", counts.x, counts.y, counts.z),
                "a spacing with at most 100000000 points",
            );
        }
        Ok(Self { origin: low, spacing, counts: counts.to_array().map(|count| count as usize) })
    }

    /// Three points along each axis around a point.
    pub(super) fn around(point: DVec3, spacing: f64) -> Self {
        Self { origin: point - spacing, spacing, counts: [3; 3] }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The point with an index.
    pub fn point(&self, index: usize) -> DVec3 {
        let [x, y, _] = self.counts;
        self.at([index % x, index / x % y, index / (x * y)])
    }

    fn at(&self, place: [usize; 3]) -> DVec3 {
        self.origin + self.spacing * DVec3::from_array(place.map(|number| number as f64))
    }

    /// Calls a function with the index and the position of every point in the box around a line and all that is within `reach` of
    /// it along an axis.
    pub(super) fn visit(&self, from: DVec3, to: DVec3, reach: f64, mut call: impl FnMut(usize, DVec3)) {
        let low = ((from.min(to) - reach - self.origin) / self.spacing).ceil().max(DVec3::ZERO);
        let high = ((from.max(to) + reach - self.origin) / self.spacing).floor();
        let [low, high] = [low, high].map(|place| place.to_array());
        let range = |axis: usize| {
            // A negative end makes the range empty.
            let end = if high[axis] < 0.0 { 0 } else { (high[axis] as usize + 1).min(self.counts[axis]) };
            low[axis] as usize..end
        };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    call(x + self.counts[0] * (y + self.counts[1] * z), self.at([x, y, z]));
                }
            }
        }
    }
}
