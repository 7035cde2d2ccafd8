//! Positions as the sum of two `f32` vectors (docs/physics section 5.8).

use std::ops::{Add, Sub};

use glam::{DVec3, Vec3};

/// The sum of two vectors. Each component of `low` is at most half a unit in the last place of the same component of `high`, so
/// that `high` is the sum rounded to `f32`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fine {
    pub(crate) high: Vec3,
    pub(crate) low: Vec3,
}

impl Fine {
    /// The nearest sum to a position.
    pub(crate) fn at(position: [f64; 3]) -> Self {
        let high = position.map(|x| x as f32);
        let low = std::array::from_fn(|axis| (position[axis] - f64::from(high[axis])) as f32);
        let high = Vec3::from_array(high);
        // A position that is not finite has no low part.
        Self { high, low: if high.is_finite() { Vec3::from_array(low) } else { Vec3::ZERO } }
    }

    /// The sum of two vectors, without rounding: it may have more digits than an `f64`.
    pub(crate) fn sum(one: Vec3, other: Vec3) -> Self {
        let (high, low) = two_sum(one, other);
        // A position that is not finite has no low part.
        Self { high, low: if high.is_finite() { low } else { Vec3::ZERO } }
    }

    /// The position in `f64`, rounded.
    pub(crate) fn wide(self) -> DVec3 {
        self.high.as_dvec3() + self.low.as_dvec3()
    }

    /// The vector from `other` to this position. The difference of the high parts is exact where the positions are near each other
    /// (Sterbenz 1974).
    pub(crate) fn minus(self, other: Self) -> Vec3 {
        let (sum, rest) = two_sum(self.high, -other.high);
        sum + (rest + (self.low - other.low))
    }

    /// This position moved by a displacement.
    pub(crate) fn moved(self, by: Vec3) -> Self {
        let (sum, rest) = two_sum(self.high, by);
        let low = rest + self.low;
        // The sum is the larger of the two, so three operations are enough (Dekker 1971).
        let high = sum + low;
        Self { high, low: low - (high - sum) }
    }
}

/// The rounded sum of two numbers or vectors, and its rounding error (Knuth 1969).
pub(crate) fn two_sum<T: Copy + Add<Output = T> + Sub<Output = T>>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiny_steps_add_up_far_from_the_origin() {
        let mut place = Fine::at([1e5, -10.0, 0.3]);
        let start = place.wide();
        let by = Vec3::new(1e-7, 3e-9, -2e-10);
        for _ in 0..100_000 {
            place = place.moved(by);
        }
        let gone = (place.wide() - start) / 100_000.0;
        for axis in 0..3 {
            let error = (gone[axis] / f64::from(by[axis]) - 1.0).abs();
            assert!(error < 1e-3, "{axis}: {error}");
        }
        assert_eq!(place, Fine::at(place.wide().to_array()), "the high part is the rounded sum");
    }

    #[test]
    fn sums_keep_more_digits_than_f64() {
        let (high, low) = (Vec3::new(17_179_870_000.0, 1.0, 0.0), Vec3::new(0.016505968, 3e-20, 0.0));
        assert_eq!(Fine::sum(high, low), Fine { high, low });
        assert_ne!(Fine::at(Fine { high, low }.wide().to_array()).low.x, low.x);
        assert_eq!(Fine::sum(Vec3::splat(1.0), Vec3::splat(3.0)), Fine { high: Vec3::splat(4.0), low: Vec3::ZERO });
        assert_eq!(Fine::sum(Vec3::MAX, Vec3::MAX).low, Vec3::ZERO);
    }

    #[test]
    fn differences_keep_all_digits() {
        let (a, b) = (Fine::at([1e6 + 0.001, 5.0, -7.25]), Fine::at([1e6 - 0.0007, 5.0 - 1e-9, 3.5]));
        let d = a.minus(b).as_dvec3();
        let exact = a.wide() - b.wide();
        assert!((d - exact).abs().max_element() <= 1e-7 * 10.75, "{d} {exact}");
        assert!((d.x - 0.0017).abs() < 1e-8 && (d.y - 1e-9).abs() < 1e-15, "{d}");
    }
}
