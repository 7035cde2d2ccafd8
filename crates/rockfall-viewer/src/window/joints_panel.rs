//! Sliders of the motors and springs of joints, and plots of joints.

use egui::{RichText, ScrollArea, Slider, SliderClamping, Ui};
use egui_plot::{Line, PlotPoints};
use rockfall::JointReading;

use super::constants_panel::row;
use super::plots::{colour, plot, stroke, widened};
use super::viewer::Viewer;
use crate::drives::{Control, Drive, controls, has_drive};

/// Height above which the sliders scroll, in points.
const HEIGHT: f32 = 150.0;
const PLOT_HEIGHT: f32 = 110.0;

/// Whether a scene has joints with sliders or plots.
pub(super) fn is_shown(viewer: &Viewer) -> bool {
    let joints = viewer.session.simulation_ref().scene().joints();
    viewer.session.played().is_none() && (joints.iter().any(has_drive) || !viewer.session.watch.graphs().is_empty())
}

/// Shows the sliders and the plots.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let controls = controls(viewer.session.simulation_ref().scene(), &viewer.session.source().scene);
    ui.spacing_mut().slider_width = 64.0;
    ui.spacing_mut().interact_size.x = 44.0;
    let mut changed = None;
    ScrollArea::vertical().id_salt("joints").max_height(HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for control in &controls {
            let reading = viewer.session.watch.joints().get(control.place).copied();
            if let Some(drive) = slider(ui, control, reading) {
                changed = Some((control.id, drive));
            }
        }
    });
    if let Some((id, drive)) = changed {
        viewer.session.drive_joint(id, drive);
    }
    plots(ui, viewer);
}

/// Shows a slider with the present position, and returns what the user has chosen.
fn slider(ui: &mut Ui, control: &Control, reading: Option<JointReading>) -> Option<Drive> {
    let Control { drive, is_angle, .. } = control;
    let (mut value, range) = control.shown();
    let (unit, word) = (control.unit(), drive.title());
    let broken = reading.is_some_and(|reading| reading.broken);
    let position = match reading {
        _ if broken => "broken".to_owned(),
        Some(reading) if *is_angle => format!("{:.1}°", reading.position.to_degrees()),
        Some(reading) => format!("{:.3}", reading.position),
        None => String::new(),
    };
    let about = format!("{word} of the joint, in {unit}. On the right: its position.");
    let mut is_changed = false;
    row(ui, &control.name, &about, |ui| {
        let widget = Slider::new(&mut value, range).clamping(SliderClamping::Never).max_decimals(2);
        is_changed = ui.add_enabled(!broken, widget).on_hover_text(&about).changed();
        ui.label(RichText::new(if unit == "degrees" { "°" } else { unit }).weak().small());
        ui.label(RichText::new(position).monospace().small());
    });
    is_changed.then(|| control.drive_of(value))
}

/// Shows the plots of joints over time.
fn plots(ui: &mut Ui, viewer: &Viewer) {
    let watch = &viewer.session.watch;
    let mut first = 0;
    for graph in watch.graphs() {
        let lines = graph.lines();
        let title = format!("{} in {} over time in s", graph.title(), graph.unit());
        ui.label(RichText::new(&title).weak().small());
        ui.horizontal_wrapped(|ui| {
            for (name, rgb) in lines {
                ui.label(RichText::new(name).color(colour(*rgb)).small());
            }
        });
        let points = |line: usize| -> Vec<[f64; 2]> {
            let all = watch.plotted().iter().map(|sample| [sample.time, sample.values[first + line]]);
            all.filter(|[_, value]| value.is_finite()).collect()
        };
        let shown: Vec<Vec<[f64; 2]>> = (0..lines.len()).map(points).collect();
        let names: Vec<&str> = lines.iter().map(|(name, _)| name.as_str()).collect();
        widened(plot(&format!("{title} {}", names.join(" ")), PLOT_HEIGHT), &shown.concat()).show(ui, |plot| {
            for ((name, rgb), points) in lines.iter().zip(shown) {
                plot.line(Line::new(name.as_str(), PlotPoints::from(points)).stroke(stroke(*rgb)));
            }
        });
        first += lines.len();
    }
}
