//! Sums of masses.

use crate::fine::two_sum;

/// A sum of `f32` that is exact as long as it fits twice the digits of an `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sum {
    pub(crate) high: f64,
    /// What is left of the sum beyond the digits of `high`.
    pub(crate) low: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, number: f32) {
        let (sum, left) = two_sum(self.high, number.into());
        (self.high, self.low) = two_sum(sum, self.low + left);
    }

    /// The sum, rounded.
    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_lose_nothing() {
        let mut sum = Sum::default();
        for number in [1e16_f32, 1.0, 3.0, 1e-8] {
            sum.add(number);
        }
        sum.add(-1e16);
        assert_eq!(sum.value(), 4.0 + f64::from(1e-8_f32), "f64 alone has 5 digits less");
    }
}
