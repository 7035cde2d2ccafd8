//! The panel: numbers, constants, colours and plots.

use egui::{Color32, RichText, Ui};
use egui_plot::{Line, PlotPoints};

use super::plots::{colour, plot, stroke, widened};
use super::viewer::Viewer;
use super::watch::GaugeSample;
use super::{constants_panel, joints_panel};
use crate::draw::{ColourBy, Style};
use crate::legend::{Legend, number};
use crate::palette::{Kind, Rgb};
use crate::plot::{self as quantities, ABSENT, COLOURS as GAUGE_COLOURS, ENERGIES};
use crate::whole;

/// Names and colours of the phases. The colours are those of Okabe and Ito.
const PHASES: [(&str, Rgb); 4] = [
    ("AABBs", [0x56, 0xb4, 0xe9]),
    ("broad phase", [0x00, 0x72, 0xb2]),
    ("collisions", [0xd5, 0x5e, 0x00]),
    ("positions", [0x00, 0x9e, 0x73]),
];
const PLOT_HEIGHT: f32 = 130.0;
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
    // The plots are above the many constants, so that a low window shows them.
    section(ui, "Energy over time", true, &mut |ui| energies(ui, viewer));
    if viewer.session.watch.gauges().back().is_some_and(|last| !last.forces.is_empty()) {
        section(ui, "Forces on walls over time", true, &mut |ui| gauges(ui, viewer));
    }
    if joints_panel::is_shown(viewer) {
        section(ui, "Joints", true, &mut |ui| joints_panel::show(ui, viewer));
    }
    section(ui, "Colours", true, &mut |ui| colours(ui, viewer));
    section(ui, "Constants", true, &mut |ui| constants_panel::show(ui, viewer));
    section(ui, "Time of the phases", false, &mut |ui| phases(ui, viewer));
}

/// Shows the numbers of steps and objects, and the rates.
fn numbers(ui: &mut Ui, viewer: &mut Viewer) {
    let session = &viewer.session;
    let simulation = session.simulation_ref();
    let (report, [bodies, rods]) = (simulation.report(), whole::counts(simulation.scene()));
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
        pair(ui, "bodies", bodies.to_string(), false);
        pair(ui, "contacts", report.contacts.to_string(), true);
        pair(ui, "rods", rods.to_string(), false);
        pair(ui, "collisions", report.collisions.to_string(), true);
    });
    // The line is always there, so that the sliders below do not move.
    let slow = session.pace.lag().map(|lag| format!("too slow: {:.0} % of the requested speed", 100.0 * lag));
    ui.label(RichText::new(slow.unwrap_or_else(|| " ".to_owned())).color(Color32::from_rgb(0xa8, 0x1e, 0x1e)));
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

fn energies(ui: &mut Ui, viewer: &mut Viewer) {
    let watch = &viewer.session.watch;
    let points =
        |index: usize| watch.energies().iter().map(move |sample| [sample.time, quantities::energies(&sample.energy)[index]]);
    let is_shown = |index: &usize| !ABSENT.contains(&ENERGIES[*index].0) || points(*index).any(|[_, energy]| energy != 0.0);
    let shown: Vec<usize> = (0..ENERGIES.len()).filter(is_shown).collect();
    if let Some(last) = watch.energies().back() {
        let energies = quantities::energies(&last.energy);
        values(ui, shown.iter().map(|index| (ENERGIES[*index], format!("{:.4}", energies[*index]))));
    }
    let lines = shown.iter().map(|index| {
        let (name, colour) = ENERGIES[*index];
        Line::new(name, points(*index).collect::<PlotPoints>()).stroke(stroke(colour))
    });
    let every: Vec<[f64; 2]> = shown.iter().flat_map(|index| points(*index)).collect();
    widened(plot("energy", PLOT_HEIGHT), &every).show(ui, |plot| lines.for_each(|line| plot.line(line)));
    if !watch.is_unasked() {
        ui.label(RichText::new("The scene is too large to measure its energy continuously.").weak());
    }
    if ui.small_button("Measure now").clicked() {
        viewer.session.sample(true);
    }
}

/// Plots the sizes of the forces on the walls of gauges.
fn gauges(ui: &mut Ui, viewer: &Viewer) {
    let samples = viewer.session.watch.gauges();
    let Some(last) = samples.back() else { return };
    let named = || last.forces.iter().zip(GAUGE_COLOURS.iter().cycle());
    ui.horizontal_wrapped(|ui| {
        for ((name, force), rgb) in named() {
            ui.label(RichText::new(format!("{name} {force:.4}")).color(colour(*rgb)).small());
        }
    });
    let points = |name: &str| -> Vec<[f64; 2]> {
        let force = |sample: &GaugeSample| sample.forces.iter().find(|(known, _)| known == name).map(|(_, force)| *force);
        samples.iter().filter_map(|sample| Some([sample.time, force(sample)?])).collect()
    };
    let every: Vec<[f64; 2]> = last.forces.iter().flat_map(|(name, _)| points(name)).collect();
    widened(plot("gauges", PLOT_HEIGHT), &every).show(ui, |plot| {
        for ((name, _), rgb) in named() {
            plot.line(Line::new(name.as_str(), points(name).into_iter().collect::<PlotPoints>()).stroke(stroke(*rgb)));
        }
    });
}

/// Shows names in their colours with the last values.
fn values(ui: &mut Ui, values: impl Iterator<Item = ((&'static str, Rgb), String)>) {
    ui.horizontal_wrapped(|ui| {
        for ((name, rgb), value) in values {
            ui.label(RichText::new(format!("{name} {value}")).color(colour(rgb)).small());
        }
    });
}

fn phases(ui: &mut Ui, viewer: &mut Viewer) {
    let samples = viewer.session.watch.phases();
    if let Some(last) = samples.back() {
        values(ui, PHASES.into_iter().zip(last.seconds.map(|seconds| format!("{:.3} ms", 1e3 * seconds))));
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
