//! How plots of the window look.

use std::ops::RangeInclusive;

use egui::Color32;
use egui_plot::{GridMark, Plot};

use crate::legend::number;
use crate::palette::Rgb;
use crate::plot::axes::{exponent, label, multiples, ranges, step};

/// Least distance of two ticks of a vertical axis, in points. The axis leaves out the numbers of nearer ones.
const TICK_DISTANCE: f32 = 30.0;

pub(super) fn colour(rgb: Rgb) -> Color32 {
    Color32::from_rgb(rgb[0], rgb[1], rgb[2])
}

pub(super) fn stroke(rgb: Rgb) -> egui::Stroke {
    egui::Stroke::new(1.5, colour(rgb))
}

pub(super) fn plot(name: &str, height: f32) -> Plot<'_> {
    Plot::new(name)
        .height(height)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .show_crosshair(false)
        .y_axis_min_width(34.0)
        .x_grid_spacer(|input| ticks(input.bounds, 5.0))
        .y_grid_spacer(move |input| ticks(input.bounds, f64::from(height / TICK_DISTANCE)))
        .x_axis_formatter(tick)
        .y_axis_formatter(tick)
}

/// Widens the axes of a plot whose points are nearly one value.
pub(super) fn widened<'a>(plot: Plot<'a>, points: &[[f64; 2]]) -> Plot<'a> {
    let [[from, to], [low, high]] = ranges(points);
    plot.include_x(from).include_x(to).include_y(low).include_y(high)
}

/// The ticks of an axis.
fn ticks((low, high): (f64, f64), most: f64) -> Vec<GridMark> {
    let marks = |step_size: f64| multiples([low, high], step_size).map(|value| GridMark { value, step_size }).collect();
    step([low, high], most).map_or_else(Vec::new, marks)
}

/// The label of a tick with the digits that its distance from the next one needs.
fn tick(mark: GridMark, range: &RangeInclusive<f64>) -> String {
    match exponent([*range.start(), *range.end()]) {
        0 => label(mark.value, mark.step_size, 0),
        _ => number(mark.value as f32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_digits_that_they_need() {
        let labels = |range: RangeInclusive<f64>, step_size: f64| {
            multiples([*range.start(), *range.end()], step_size)
                .map(|value| tick(GridMark { value, step_size }, &range))
                .collect()
        };
        let found: [Vec<String>; 3] = [labels(0.0..=1.0, 0.5), labels(-1.0..=0.2, 0.5), labels(0.0..=3e6, 1e6)];
        assert_eq!(found, [vec!["0.0", "0.5", "1.0"], vec!["-1.0", "-0.5", "0.0"], vec!["0", "1e6", "2e6", "3e6"]]);
    }
}
