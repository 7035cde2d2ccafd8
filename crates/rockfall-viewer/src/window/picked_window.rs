//! The values of the picked body and its motion over time, in a window of its own, so that the panel does not move.

use egui::{Rect, RichText, Ui};
use egui_plot::{Line, PlotPoints};

use super::panel;
use super::track::Point;
use super::viewer::Viewer;

const WIDTH: f32 = 300.0;
/// Size of the text of the values, in points.
const TEXT: f32 = 11.0;
const PLOT_HEIGHT: f32 = 84.0;
/// Number of points above which only some are drawn.
const MOST_POINTS: usize = 1000;

/// Shows the window if a body is picked. It opens in the upper left corner of the picture, beside its middle.
pub(super) fn show(ui: &Ui, area: Rect, viewer: &mut Viewer) {
    let Some(facts) = viewer.session.watch.facts().cloned().filter(|_| viewer.session.picked().is_some()) else {
        return;
    };
    let mut open = true;
    let window = egui::Window::new(&facts.title).id(egui::Id::unique("picked body")).open(&mut open).resizable(false);
    window.default_pos(area.left_top() + egui::vec2(8.0, 8.0)).constrain_to(area).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        egui::Grid::new("picked").num_columns(2).spacing([8.0, 2.0]).show(ui, |ui| {
            for (name, value) in &facts.values {
                ui.label(RichText::new(*name).weak().size(TEXT));
                ui.label(RichText::new(value).monospace().size(TEXT));
                ui.end_row();
            }
        });
        motion(ui, viewer);
    });
    if !open {
        viewer.session.set_picked(None);
    }
}

/// Shows height and speed over time, and the button for the table.
fn motion(ui: &mut Ui, viewer: &mut Viewer) {
    let up = viewer.session.up();
    let points = viewer.session.track().points();
    if points.is_empty() {
        return;
    }
    let stride = points.len().div_ceil(MOST_POINTS);
    let line = |name: &'static str, value: &dyn Fn(&Point) -> f32, colour| {
        // The last point is always drawn.
        let some = points.iter().rev().step_by(stride).map(|point| [point.time, f64::from(value(point))]);
        Line::new(name, some.collect::<PlotPoints>()).stroke(panel::stroke(colour))
    };
    let height = line("height", &|point| point.position.dot(up), [0x00, 0x72, 0xb2]);
    let speed = line("speed", &|point| point.velocity.length(), [0xd5, 0x5e, 0x00]);
    for (title, line) in [("height in units over time in s", height), ("speed in units/s over time in s", speed)] {
        ui.label(RichText::new(title).weak().small());
        panel::plot(title, PLOT_HEIGHT).show(ui, |plot| plot.line(line));
    }
    let count = points.len();
    ui.horizontal(|ui| {
        if ui.button("Save as CSV").on_hover_text("time, position, velocity, height and speed").clicked() {
            viewer.save_track();
        }
        ui.label(RichText::new(format!("{count} points")).weak().small());
    });
}
