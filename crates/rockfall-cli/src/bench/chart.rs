//! Chart of the time of each phase for different numbers of spheres, as in Figure 2.11 of the thesis.
//!
//! The stacked bars are from a run with timestamps around every dispatch. A black line marks the time of a whole step without
//! timestamps.

use std::io::{self, Write as _};

use plotters::prelude::*;
use rockfall::output::AtomicFile;

use crate::bench::measure::Measured;
use crate::bench::phases::PHASES;

const SIZE: (u32, u32) = (900, 560);
/// Half the width of a bar. The distance between bars is 1.
const HALF: f64 = 0.32;
/// One colour for each phase, also distinguishable with colour blindness.
const COLOURS: [RGBColor; 4] =
    [RGBColor(0x44, 0x77, 0xaa), RGBColor(0x66, 0xcc, 0xee), RGBColor(0xcc, 0xbb, 0x44), RGBColor(0xee, 0x66, 0x77)];

/// Draws the chart and writes the file.
pub(crate) fn write(title: &str, sizes: &[Measured], mut file: AtomicFile) -> io::Result<()> {
    let bars: Vec<Bar> = sizes.iter().filter_map(Bar::of).collect();
    let mut svg = String::new();
    draw(title, &bars, &mut svg).map_err(io::Error::other)?;
    file.write_all(svg.as_bytes())?;
    file.commit()
}

/// Milliseconds per step of each phase, and of a whole step of the plain runs.
struct Bar {
    spheres: usize,
    phases: [f64; 4],
    plain: f64,
}

impl Bar {
    fn of(size: &Measured) -> Option<Self> {
        size.profile.as_ref()?;
        Some(Self {
            spheres: size.counts.spheres,
            plain: 1e3 * size.seconds.median / size.steps as f64,
            phases: PHASES.map(|(phase, ..)| 1e3 * size.phase_seconds(phase).unwrap_or_default()),
        })
    }
}

fn draw(title: &str, bars: &[Bar], svg: &mut String) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let highest = bars.iter().map(|bar| bar.plain.max(bar.phases.iter().sum())).fold(1e-6, f64::max);
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(-0.5..bars.len().max(1) as f64 - 0.5, 0.0..1.3 * highest)?;
    let spheres = |place: &f64| {
        let bar = bars.get(place.round().max(0.0) as usize);
        bar.filter(|_| place.fract() == 0.0).map_or(String::new(), |bar| bar.spheres.to_string())
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(WHITE)
        // Enough labels for one at each bar. Labels between bars are empty.
        .x_labels(2 * bars.len() + 1)
        .x_label_formatter(&spheres)
        .x_desc("spheres")
        .y_desc("ms per step")
        .draw()?;
    for (phase, (_, name, _)) in PHASES.iter().enumerate() {
        let colour = COLOURS[phase];
        let rectangles = bars.iter().zip(0..).map(|(bar, place)| {
            let below: f64 = bar.phases[..phase].iter().sum();
            let place = f64::from(place);
            Rectangle::new([(place - HALF, below), (place + HALF, below + bar.phases[phase])], colour.filled())
        });
        chart
            .draw_series(rectangles)?
            .label(*name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 14, y + 5)], colour.filled()));
    }
    let whole = bars.iter().zip(0..).map(|(bar, place)| {
        let ends = [-HALF, HALF].map(|side| (f64::from(place) + side, bar.plain));
        PathElement::new(ends, BLACK.stroke_width(2))
    });
    chart
        .draw_series(whole)?
        .label("Whole step, without timestamps")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 14, y)], BLACK.stroke_width(2)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.filled())
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bar_is_labelled_with_its_number_of_spheres() {
        for count in 1..12 {
            let bars: Vec<Bar> =
                (0..count).map(|place| Bar { spheres: 1000 << place, phases: [1e-4, 2e-3, 1e-3, 0.0], plain: 2e-3 }).collect();
            let mut svg = String::new();
            draw("title", &bars, &mut svg).unwrap();
            for bar in &bars {
                let label = format!("\n{}\n", bar.spheres);
                assert!(svg.contains(&label), "{label} of {count}: {svg}");
            }
        }
    }

    #[test]
    fn an_empty_chart_does_not_panic() {
        draw("title", &[], &mut String::new()).unwrap();
    }
}
