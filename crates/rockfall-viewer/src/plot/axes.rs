//! Ranges of axes and their ticks.

/// Least range of a vertical axis, divided by the greatest value.
const LEAST_RANGE: f64 = 0.02;
/// Least range of the axis of the time, in s.
const LEAST_TIME: f64 = 1.0;

/// The least and the greatest of the finite values; `None` without any.
pub(crate) fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let found = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    (found[0] <= found[1]).then_some(found)
}

/// Returns the range of a vertical axis. It is so wide that rounding errors do not fill a plot of what stays the same.
pub(crate) fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let size = low.abs().max(high.abs());
    let least = if size > 0.0 { LEAST_RANGE * size } else { 1.0 };
    let room = (0.5 * (least - (high - low))).max(0.0);
    [low - room, high + room]
}

/// Returns the ranges of both axes for points, also before the run, when there is only one.
#[cfg_attr(not(feature = "window"), allow(dead_code))]
pub(crate) fn ranges(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let range = |axis: usize| extent(points.iter().map(|point| point[axis])).unwrap_or([0.0; 2]);
    let [from, to] = range(0);
    [[from, to.max(from + LEAST_TIME)], widened(range(1))]
}

/// Returns the distance of at most this number of ticks: 1, 2 or 5 times a power of ten. `None` for an empty range.
pub(crate) fn step([low, high]: [f64; 2], most: f64) -> Option<f64> {
    let least = (high - low) / most.max(1.0);
    if !(least.is_finite() && least > 0.0) {
        return None;
    }
    let power = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|step| step * power);
    Some(steps.into_iter().find(|step| *step >= least).unwrap_or(10.0 * power))
}

/// The multiples of a step in a range. Rounding errors do not drop the ends.
pub(crate) fn multiples([low, high]: [f64; 2], step: f64) -> impl Iterator<Item = f64> {
    let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
    (first..=last).map(move |tick| tick as f64 * step)
}

/// The power of ten, a multiple of 3, by which the labels of an axis are divided: 0 where they are short without it.
pub(crate) fn exponent([low, high]: [f64; 2]) -> i32 {
    let size = low.abs().max(high.abs());
    if size == 0.0 || (0.01..1e4).contains(&size) {
        return 0;
    }
    3 * (size.log10() / 3.0).floor() as i32
}

/// The label of a tick with the digits that its distance from the next one needs.
pub(crate) fn label(value: f64, step: f64, exponent: i32) -> String {
    let scale = 10_f64.powi(-exponent);
    let decimals = (-(step * scale * (1.0 + 1e-9)).log10().floor()).clamp(0.0, 9.0) as usize;
    // Adding 0 makes -0 0.
    format!("{:.decimals$}", value * scale + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let values =
            |range: [f64; 2]| -> Vec<f64> { step(range, 3.0).map_or_else(Vec::new, |step| multiples(range, step).collect()) };
        assert_eq!(values([0.4, 0.75]), [0.4, 0.6000000000000001]);
        assert_eq!(values([-1.0, 11.0]), [0.0, 5.0, 10.0]);
        assert_eq!(values([100.0, 450.0]), [200.0, 400.0]);
        assert!(values([1.0, 1.0]).is_empty() && values([f64::NAN, 1.0]).is_empty());
    }

    /// Before the run there is one point; later a value may differ by rounding errors only.
    #[test]
    fn plots_of_one_value_have_a_scale() {
        assert_eq!(ranges(&[]), [[0.0, 1.0], [-0.5, 0.5]]);
        assert_eq!(ranges(&[[0.0, 200.0]]), [[0.0, 1.0], [198.0, 202.0]]);
        let [[from, to], [low, high]] = ranges(&[[0.0, 3.0], [4.0, 3.0 + 1e-9]]);
        assert!((from, to) == (0.0, 4.0) && low < 2.98 && high > 3.02, "{low} {high}");
        assert_eq!(ranges(&[[1.0, -2.0], [4.0, 5.0]]), [[1.0, 4.0], [-2.0, 5.0]]);
    }

    #[test]
    fn labels_have_the_digits_that_they_need() {
        assert_eq!([label(0.6000000000000001, 0.2, 0), label(-0.0, 5.0, 0), label(1.25, 0.05, 0)], ["0.6", "0", "1.25"]);
        assert_eq!([exponent([0.0, 2500.0]), exponent([-3e7, 0.0]), exponent([0.0, 0.002])], [0, 6, -3]);
        assert_eq!([label(-3e7, 5e6, 6), label(0.0015, 0.0005, -3)], ["-30", "1.5"]);
    }
}
