//! Plots: theory as lines, measurements as points.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::Result;
use crate::number::digits;

const SIZE: (u32, u32) = (720, 440);
/// Colours that are also distinguishable with colour blindness (Tol's bright scheme).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x44, 0x77, 0xaa),
    RGBColor(0xee, 0x66, 0x77),
    RGBColor(0x22, 0x88, 0x33),
    RGBColor(0xaa, 0x33, 0x77),
    RGBColor(0xcc, 0x99, 0x22),
    RGBColor(0x66, 0xcc, 0xee),
];

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    label: &'static str,
    logarithmic: bool,
}

impl Axis {
    /// A linear axis; the label names the quantity and its unit.
    pub fn linear(label: &'static str) -> Self {
        Self { label, logarithmic: false }
    }

    /// A logarithmic axis, to base 10.
    pub fn logarithmic(label: &'static str) -> Self {
        Self { label, logarithmic: true }
    }

    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    fn tick(&self, place: f64) -> String {
        if !self.logarithmic {
            return digits(if place.abs() < 1e-12 { 0.0 } else { place });
        }
        // Adding 0 turns -0 into 0.
        let power = place.round() + 0.0;
        if (place - power).abs() < 1e-9 {
            return format!("1e{power}");
        }
        // Values between powers of ten have two significant digits.
        let value = 10_f64.powf(place);
        format!("{value:.*}", (1.0 - place.floor()).max(0.0) as usize)
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Theory.
    Line,
    /// Measurement.
    Points,
}

#[derive(Clone, Debug)]
struct Series {
    label: String,
    mark: Mark,
    colour: usize,
    points: Vec<(f64, f64)>,
}

/// A plot of one experiment.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Name of the file, without the extension.
    pub name: &'static str,
    /// Title of the plot.
    pub title: &'static str,
    x: Axis,
    y: Axis,
    series: Vec<Series>,
}

impl Chart {
    /// Creates an empty plot.
    pub fn new(name: &'static str, title: &'static str, x: Axis, y: Axis) -> Self {
        Self { name, title, x, y, series: Vec::new() }
    }

    /// Adds a series. `colour` is an index; theory and measurement of the same quantity share a colour.
    pub fn add(mut self, colour: usize, mark: Mark, label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        self.series.push(Series { label: label.into(), mark, colour, points });
        self
    }

    /// Draws the plot as SVG.
    ///
    /// # Errors
    /// Returns an error if there are no points to plot.
    pub fn svg(&self) -> Result<String> {
        let mut svg = String::new();
        self.draw(&mut svg)?;
        Ok(svg)
    }

    fn places(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let places = points.iter().map(|(x, y)| (self.x.place(*x), self.y.place(*y)));
        places.filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
    }

    fn range(&self, of: impl Fn(&(f64, f64)) -> f64, above: f64) -> Result<std::ops::Range<f64>> {
        let all = self.series.iter().flat_map(|series| self.places(&series.points));
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            let value = of(&point);
            (low.min(value), high.max(value))
        });
        if low > high {
            return Err(format!("the plot {} is empty", self.name).into());
        }
        let span = (high - low).max(1e-9 * high.abs()).max(1e-12);
        Ok(low - 0.04 * span..high + above * span)
    }

    fn draw(&self, svg: &mut String) -> Result<()> {
        let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        // Leaves space for the legend above the curves.
        let room = 0.1 + 0.07 * self.series.len() as f64;
        let mut chart = ChartBuilder::on(&root)
            .caption(self.title, ("sans-serif", 17))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(70)
            .build_cartesian_2d(self.range(|point| point.0, 0.04)?, self.range(|point| point.1, room)?)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .x_labels(8)
            .y_labels(7)
            .x_label_formatter(&|place| self.x.tick(*place))
            .y_label_formatter(&|place| self.y.tick(*place))
            .x_desc(self.x.label)
            .y_desc(self.y.label)
            .draw()?;
        for series in &self.series {
            self.draw_series(&mut chart, series)?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.9).filled())
            .border_style(BLACK.mix(0.3))
            .draw()?;
        root.present()?;
        Ok(())
    }

    fn draw_series<'a>(
        &self,
        chart: &mut ChartContext<'a, SVGBackend<'_>, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
        series: &Series,
    ) -> Result<()> {
        let colour = COLOURS[series.colour % COLOURS.len()];
        let places = self.places(&series.points);
        match series.mark {
            Mark::Line => chart
                .draw_series([PathElement::new(places, colour.stroke_width(2))])?
                .label(&series.label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2))),
            Mark::Points => chart
                .draw_series(places.into_iter().map(|place| Circle::new(place, 3, colour.filled())))?
                .label(&series.label)
                .legend(move |(x, y)| Circle::new((x + 8, y), 3, colour.filled())),
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_and_series_are_drawn_reproducibly() {
        let chart = Chart::new("n", "A title", Axis::linear("time (s)"), Axis::logarithmic("speed (units/s)"))
            .add(0, Mark::Line, "theory", vec![(0.0, 1.0), (1.0, 100.0)])
            .add(0, Mark::Points, "measured", vec![(0.5, 10.0), (0.6, 0.0)]);
        let svg = chart.svg().unwrap();
        for text in ["A title", "time (s)", "speed (units/s)", "theory", "measured", "1e1"] {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        // One circle in the plot and one in the legend: the point at 0 cannot be drawn on a logarithmic axis.
        assert_eq!(svg.matches("<circle").count(), 2);
        assert_eq!(svg, chart.svg().unwrap());
    }

    #[test]
    fn an_empty_plot_is_an_error() {
        let chart = Chart::new("n", "t", Axis::linear("x"), Axis::linear("y"));
        assert!(chart.svg().unwrap_err().to_string().contains("empty"));
    }
}
