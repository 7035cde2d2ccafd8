//! Widgets of the window: the menu, the picture of the scene with marks and messages over it, and the panel.

use egui::{Align2, Color32, FontId, Pos2, Rect, RichText, TextureId, Ui};
use rockfall::glam::Vec2;

use super::message::Level;
use super::viewer::Viewer;
use super::{controls, file_window, input, marks, menu, overlay, panel, picked_window, quit_window, transport};
use crate::draw::Motion;
use crate::overlay::Mark;

/// Height of letters over the picture, in points.
const LETTERS: f32 = 15.0;

/// Takes the size of the picture in pixels, whether it is moving, and what makes marks over it. Returns the texture that the scene
/// will be drawn onto, and the marks.
pub(super) type PictureOf<'a> = dyn FnMut([u32; 2], bool, &dyn Fn(&Motion) -> Vec<Mark>) -> (TextureId, Vec<Mark>) + 'a;

/// Shows all widgets of a frame.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer, picture: &mut PictureOf<'_>) {
    for file in ui.input(|input| input.raw.dropped_files.clone()) {
        viewer.load(file.path());
    }
    egui::Panel::top("menu").show(ui, |ui| menu::show(ui, viewer));
    egui::Panel::bottom("transport").show(ui, |ui| transport::show(ui, viewer));
    if viewer.panel {
        egui::Panel::right("panel").default_size(320.0).size_range(240.0..=560.0).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| panel::show(ui, viewer));
        });
    }
    let area = ui.available_rect_before_wrap();
    let pixels = ui.ctx().pixels_per_point();
    viewer.origin = Vec2::new(area.min.x, area.min.y) * pixels;
    viewer.resize(Vec2::new(area.width() * pixels, area.height() * pixels));
    input::handle(ui, area, viewer);
    // A software device draws moving scenes coarsely, but not for a film.
    let moving = (viewer.is_moving() || viewer.is_dragging()) && !viewer.capture.wants_picture();
    let size = viewer.size();
    let marks_of = |motion: &Motion| viewer.overlay.marks(motion, &viewer.camera, size.to_array(), LETTERS * pixels);
    let (texture, over_picture) = picture([size.x as u32, size.y as u32], moving, &marks_of);
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(texture, area, whole, Color32::WHITE);
    let over = ui.painter().with_clip_rect(area);
    overlay::show(&over, area.min, 1.0 / pixels, &over_picture);
    marks::show(&over, area, viewer);
    hint(&over, area, viewer);
    picked_window::show(ui, area, viewer);
    messages(ui, area, viewer);
    all_messages(ui, viewer);
    help(ui, viewer);
    file_window::show(ui, viewer);
    quit_window::show(ui, viewer);
    viewer.busy = ui.ctx().egui_wants_keyboard_input() || egui::Popup::is_any_open(ui.ctx());
}

/// Draws a hint about the first steps.
fn hint(painter: &egui::Painter, area: Rect, viewer: &Viewer) {
    if !viewer.session.running() && viewer.session.simulation_ref().report().steps == 0 {
        let text = "Space starts   ·   F1 shows all keys   ·   drop a scene file here to open it";
        let at = area.center_bottom() - egui::vec2(0.0, 16.0);
        painter.text(at, Align2::CENTER_BOTTOM, text, FontId::proportional(15.0), Color32::from_gray(90));
    }
}

fn colour_of(level: Level) -> Color32 {
    match level {
        Level::Note => Color32::from_gray(60),
        Level::Warning => Color32::from_rgb(0x8a, 0x5a, 0x00),
        Level::Error => Color32::from_rgb(0xa8, 0x1e, 0x1e),
    }
}

fn messages(ui: &Ui, area: Rect, viewer: &mut Viewer) {
    let shown: Vec<(usize, Level, String)> =
        viewer.session.shown_messages().map(|(index, message)| (index, message.level, message.text.clone())).collect();
    if shown.is_empty() {
        return;
    }
    // Messages disappear without input.
    ui.ctx().request_repaint_after_secs(1.0);
    egui::Area::new(egui::Id::unique("messages"))
        .fixed_pos(area.left_bottom() + egui::vec2(12.0, -12.0))
        .pivot(Align2::LEFT_BOTTOM)
        .show(ui.ctx(), |ui| {
            for (index, level, text) in shown {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width((area.width() - 40.0).clamp(100.0, 640.0));
                    ui.horizontal_wrapped(|ui| {
                        if ui.small_button("×").clicked() {
                            viewer.session.messages.dismiss(index);
                        }
                        ui.label(RichText::new(text).color(colour_of(level)));
                    });
                });
            }
        });
}

/// Shows all messages, the last first.
fn all_messages(ui: &Ui, viewer: &mut Viewer) {
    let all = viewer.session.messages.all();
    egui::Window::new("Messages").open(&mut viewer.messages).default_width(520.0).show(ui.ctx(), |ui| {
        egui::ScrollArea::vertical().max_height(360.0).auto_shrink([false, true]).show(ui, |ui| {
            if all.is_empty() {
                ui.label("There are no messages.");
            }
            for message in all.iter().rev() {
                ui.label(RichText::new(&message.text).color(colour_of(message.level)));
            }
        });
    });
}

fn help(ui: &Ui, viewer: &mut Viewer) {
    let controls = viewer.controls;
    let window = egui::Window::new("Keys and mouse").open(&mut viewer.help).resizable(false).collapsible(false);
    window.anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        let mut rows: Vec<(String, String)> =
            controls::mouse_rows(controls).map(|(keys, what)| (keys.to_owned(), what.to_owned())).collect();
        rows.extend(controls::key_rows(controls));
        let half = rows.len().div_ceil(2);
        ui.horizontal_top(|ui| {
            for (column, rows) in rows.chunks(half).enumerate() {
                egui::Grid::new(("keys", column)).num_columns(2).spacing([14.0, 4.0]).show(ui, |ui| {
                    for (keys, what) in rows {
                        ui.strong(keys);
                        ui.label(what);
                        ui.end_row();
                    }
                });
                ui.add_space(18.0);
            }
        });
    });
}

#[cfg(test)]
#[path = "ui_tests.rs"]
mod tests;
