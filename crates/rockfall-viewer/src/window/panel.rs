//! The panel: numbers, constants, colours and plots.

use egui::{Color32, RichText, Ui};
use egui_plot::{GridMark, Line, Plot, PlotPoints};
use rockfall::{Counts, Energy};

use super::constants_panel;
use super::viewer::Viewer;
use crate::draw::{ColourBy, Style};
use crate::legend::{Legend, number};
use crate::palette::{Kind, Rgb};

/// Names and colours of the energies. The colours here and in [`PHASES`] are those of Okabe and Ito, which can be told apart
/// with any kind of colour vision.
const ENERGIES: [(&str, Rgb); 5] = [
    ("total", [0x30, 0x30, 0x30]),
    ("kinetic", [0xd5, 0x5e, 0x00]),
    ("potential", [0x00, 0x72, 0xb2]),
    ("springs", [0x00, 0x9e, 0x73]),
    ("contacts", [0xcc, 0x79, 0xa7]),
];
/// Names and colours of the phases.
const PHASES: [(&str, Rgb); 4] = [
    ("AABBs", [0x56, 0xb4, 0xe9]),
    ("broad phase", [0x00, 0x72, 0xb2]),
    ("collisions", [0xd5, 0x5e, 0x00]),
    ("positions", [0x00, 0x9e, 0x73]),
];
const PLOT_HEIGHT: f32 = 130.0;
/// Least range of a vertical axis, divided by the greatest value.
const LEAST_RANGE: f64 = 0.02;
/// Least range of the axis of the time, in s.
const LEAST_TIME: f64 = 1.0;
/// Least distance of two ticks of a vertical axis, in points. The axis leaves out the numbers of nearer ones.
const TICK_DISTANCE: f32 = 30.0;
/// Width of the scroll bar beside the panel.
const SCROLL_BAR: f32 = 10.0;

/// Shows the panel.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    // The scroll bar must not cover anything.
    ui.set_max_width(ui.available_width() - SCROLL_BAR);
    numbers(ui, viewer);
    let section = |ui: &mut Ui, title: &str, open: bool, add: &mut dyn FnMut(&mut Ui)| {
        egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(open).show(ui, add);
    };
    section(ui, "Constants", true, &mut |ui| constants_panel::show(ui, viewer));
    section(ui, "Colours", true, &mut |ui| colours(ui, viewer));
    section(ui, "Energy over time", true, &mut |ui| energies(ui, viewer));
    section(ui, "Time of the phases", false, &mut |ui| phases(ui, viewer));
}

/// Shows the numbers of steps and objects, and the rates.
fn numbers(ui: &mut Ui, viewer: &mut Viewer) {
    let session = &viewer.session;
    let simulation = session.simulation_ref();
    let (report, counts) = (simulation.report(), simulation.scene().counts());
    ui.label(RichText::new(&session.source().name).strong());
    ui.label(RichText::new(format!("{} · {}", simulation.backend().device, simulation.broad_phase_method())).weak());
    egui::Grid::new("numbers").num_columns(4).spacing([10.0, 2.0]).show(ui, |ui| {
        let pair = |ui: &mut Ui, name: &str, value: String, last: bool| {
            ui.label(RichText::new(name).weak());
            ui.monospace(value);
            if last {
                ui.end_row();
            }
        };
        pair(ui, "time", format!("{:.2} s", report.time), false);
        pair(ui, "steps", report.steps.to_string(), true);
        pair(ui, "steps/s", format!("{:.0}", viewer.rates.steps), false);
        pair(ui, "frames/s", format!("{:.0}", viewer.rates.frames), true);
        pair(ui, "bodies", bodies(&counts).to_string(), false);
        pair(ui, "contacts", report.contacts.to_string(), true);
        pair(ui, "rods", counts.rods.saturating_sub(counts.capsules).to_string(), false);
        pair(ui, "collisions", report.collisions.to_string(), true);
    });
    // The line is always there, so that the sliders below do not move.
    let slow = session.pace.lag().map(|lag| format!("too slow: {:.0} % of the requested speed", 100.0 * lag));
    ui.label(RichText::new(slow.unwrap_or_else(|| " ".to_owned())).color(Color32::from_rgb(0xa8, 0x1e, 0x1e)));
}

/// Returns the number of spheres and capsules. The two ends of a capsule are spheres of the scene, but one body.
fn bodies(counts: &Counts) -> usize {
    counts.spheres.saturating_sub(counts.capsules)
}

/// Shows the switches of the style.
pub(super) fn style_switches(ui: &mut Ui, viewer: &mut Viewer) {
    let Style { shadows, occlusion, ground, .. } = &mut viewer.style;
    ui.checkbox(shadows, "Shadows");
    ui.checkbox(occlusion, "Ambient occlusion");
    ui.checkbox(ground, "Ground");
}

fn colours(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal_wrapped(|ui| {
        for by in ColourBy::ALL {
            ui.selectable_value(&mut viewer.style.colour_by, by, by.name());
        }
    });
    match &viewer.legend {
        Some(Legend::Kinds(kinds)) => {
            ui.horizontal_wrapped(|ui| kinds.iter().for_each(|kind| swatch(ui, kind)));
        }
        Some(Legend::Scale { title, range, colours }) => scale(ui, title, *range, colours),
        None => {}
    }
}

pub(super) fn colour(rgb: Rgb) -> Color32 {
    Color32::from_rgb(rgb[0], rgb[1], rgb[2])
}

fn swatch(ui: &mut Ui, kind: &Kind) {
    let (place, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(place, 3.0, colour(kind.colour));
    ui.label(kind.name);
}

/// Shows a colour bar with the values at its ends.
fn scale(ui: &mut Ui, title: &str, range: [f32; 2], colours: &[Rgb]) {
    let (bar, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 12.0), egui::Sense::hover());
    let mut mesh = egui::Mesh::default();
    let last = colours.len().saturating_sub(1).max(1) as f32;
    for (index, rgb) in colours.iter().enumerate() {
        let x = egui::lerp(bar.x_range(), index as f32 / last);
        for y in [bar.top(), bar.bottom()] {
            mesh.colored_vertex(egui::pos2(x, y), colour(*rgb));
        }
    }
    for left in (0..2 * (colours.len() as u32).saturating_sub(1)).step_by(2) {
        mesh.add_triangle(left, left + 1, left + 2);
        mesh.add_triangle(left + 1, left + 2, left + 3);
    }
    ui.painter().add(mesh);
    ui.horizontal(|ui| {
        ui.monospace(number(range[0]));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.monospace(number(range[1]));
            ui.centered_and_justified(|ui| ui.monospace(number(0.5 * (range[0] + range[1]))));
        });
    });
    ui.vertical_centered(|ui| ui.label(RichText::new(title).weak()));
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
}

/// Widens the axes of a plot whose points are nearly one value.
pub(super) fn widened<'a>(plot: Plot<'a>, points: &[[f64; 2]]) -> Plot<'a> {
    let [[from, to], [low, high]] = ranges(points);
    plot.include_x(from).include_x(to).include_y(low).include_y(high)
}

/// Returns the ranges of both axes. They are so wide that rounding errors do not fill a plot: before the run, and for what stays
/// the same.
fn ranges(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let range = |axis: usize| {
        let values = points.iter().map(|point| point[axis]).filter(|value| value.is_finite());
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        if low <= high { [low, high] } else { [0.0; 2] }
    };
    let ([from, to], [low, high]) = (range(0), range(1));
    let size = low.abs().max(high.abs());
    let least = if size > 0.0 { LEAST_RANGE * size } else { 1.0 };
    let room = (0.5 * (least - (high - low))).max(0.0);
    [[from, to.max(from + LEAST_TIME)], [low - room, high + room]]
}

/// Returns at most this number of ticks, and at least two where possible, at multiples of 1, 2 or 5 times a power of ten.
fn ticks((low, high): (f64, f64), most: f64) -> Vec<GridMark> {
    let least = (high - low) / most.max(1.0);
    if !(least.is_finite() && least > 0.0) {
        return Vec::new();
    }
    let power = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0].map(|step| step * power).into_iter().find(|step| *step >= least).unwrap_or(10.0 * power);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|tick| GridMark { value: tick as f64 * step, step_size: step }).collect()
}

fn energies(ui: &mut Ui, viewer: &mut Viewer) {
    let watch = &viewer.session.watch;
    let all = |energy: &Energy| [energy.total(), energy.kinetic, energy.potential, energy.spring, energy.contact];
    if let Some(last) = watch.energies().back() {
        // Without contacts the energy is -0; adding 0 makes it 0.
        values(ui, &ENERGIES, all(&last.energy).map(|energy| format!("{:.4}", energy + 0.0)));
    }
    let points = |index: usize| watch.energies().iter().map(move |sample| [sample.time, all(&sample.energy)[index]]);
    let lines = ENERGIES
        .iter()
        .enumerate()
        .map(|(index, (name, colour))| Line::new(*name, points(index).collect::<PlotPoints>()).stroke(stroke(*colour)));
    let every: Vec<[f64; 2]> = (0..ENERGIES.len()).flat_map(points).collect();
    widened(plot("energy", PLOT_HEIGHT), &every).show(ui, |plot| lines.for_each(|line| plot.line(line)));
    if !watch.is_unasked() {
        ui.label(RichText::new("The scene is too large to measure its energy continuously.").weak());
    }
    if ui.small_button("Measure now").clicked() {
        viewer.session.sample(true);
    }
}

/// Shows names in their colours with the last values.
fn values<const N: usize>(ui: &mut Ui, names: &[(&str, Rgb); N], values: [String; N]) {
    ui.horizontal_wrapped(|ui| {
        for ((name, rgb), value) in names.iter().zip(values) {
            ui.label(RichText::new(format!("{name} {value}")).color(colour(*rgb)).small());
        }
    });
}

fn phases(ui: &mut Ui, viewer: &mut Viewer) {
    let samples = viewer.session.watch.phases();
    if let Some(last) = samples.back() {
        values(ui, &PHASES, last.seconds.map(|seconds| format!("{:.3} ms", 1e3 * seconds)));
    } else if viewer.session.simulation_ref().clock().is_err() {
        ui.label(RichText::new("This device has no timestamps.").weak());
    }
    let lines = PHASES.iter().enumerate().map(|(index, (name, colour))| {
        let points = samples.iter().map(|sample| [sample.time, 1e3 * sample.seconds[index]]);
        Line::new(*name, points.collect::<PlotPoints>()).stroke(stroke(*colour))
    });
    let plot = plot("phases", PLOT_HEIGHT).include_y(0.0);
    let plot = if samples.is_empty() { widened(plot, &[]) } else { plot };
    plot.show(ui, |plot| lines.for_each(|line| plot.line(line)));
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let values = |low: f64, high: f64| ticks((low, high), 3.0).iter().map(|tick| tick.value).collect::<Vec<f64>>();
        assert_eq!(values(0.4, 0.75), [0.4, 0.6000000000000001]);
        assert_eq!(values(-1.0, 11.0), [0.0, 5.0, 10.0]);
        assert_eq!(values(100.0, 450.0), [200.0, 400.0]);
        assert!(values(1.0, 1.0).is_empty() && values(f64::NAN, 1.0).is_empty());
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
    fn a_capsule_is_one_body() {
        let text = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\nC 3 0 0 4 0 0 0 0 0 1 0.2\nC 3 3 0 4 3 0 0 0 0 1 0.2\n";
        let counts = rockfall::Scene::parse(text, Path::new("test")).unwrap().scene.counts();
        assert_eq!((counts.spheres, bodies(&counts)), (5, 3));
    }
}
