//! Median, minimum and maximum of several runs.

use serde_json::{Value, json};

/// Median, minimum and maximum of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spread {
    pub(crate) median: f64,
    pub(crate) min: f64,
    pub(crate) max: f64,
}

impl Spread {
    /// Computes the spread of some numbers; all 0 for an empty list.
    pub(crate) fn of(mut numbers: Vec<f64>) -> Self {
        numbers.sort_by(f64::total_cmp);
        let at = |place: usize| numbers.get(place).copied().unwrap_or_default();
        let count = numbers.len();
        Self { median: 0.5 * (at(count.saturating_sub(1) / 2) + at(count / 2)), min: at(0), max: at(count.saturating_sub(1)) }
    }

    /// Spread of `one` divided by these numbers, such as steps per second from seconds.
    pub(crate) fn inverse(self, one: f64) -> Self {
        Self { median: one / self.median, min: one / self.max, max: one / self.min }
    }

    pub(crate) fn json(self) -> Value {
        json!({ "median": self.median, "min": self.min, "max": self.max })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_of_odd_even_and_empty_lists() {
        let spread = |numbers: &[f64]| {
            let Spread { median, min, max } = Spread::of(numbers.to_vec());
            [median, min, max]
        };
        assert_eq!(spread(&[]), [0.0; 3]);
        assert_eq!(spread(&[3.0]), [3.0; 3]);
        assert_eq!(spread(&[4.0, 1.0]), [2.5, 1.0, 4.0]);
        assert_eq!(spread(&[9.0, 1.0, 2.0]), [2.0, 1.0, 9.0]);
        let inverse = Spread::of(vec![1.0, 2.0, 4.0]).inverse(8.0);
        assert_eq!([inverse.median, inverse.min, inverse.max], [4.0, 2.0, 8.0]);
    }
}
