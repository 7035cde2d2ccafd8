//! Widgets of the window: the menu, the picture of the scene with marks and messages over it, and the panel.

use egui::{Align2, Color32, FontId, Pos2, Rect, RichText, Stroke, TextureId, Ui};
use rockfall::glam::{Vec2, Vec3};
use rockfall::{Body, Simulation};

use super::controls::{self, Command};
use super::message::Level;
use super::viewer::Viewer;
use super::{file_window, input, panel};

/// Colour of the marks on bodies.
const MARK: Color32 = Color32::from_rgb(0xd5, 0x5e, 0x00);

/// Shows all widgets of a frame. `picture` takes the size of the picture in pixels and whether it is moving, and returns the
/// texture that the scene will be drawn onto.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer, picture: &mut dyn FnMut([u32; 2], bool) -> TextureId) {
    for file in ui.input(|input| input.raw.dropped_files.clone()) {
        viewer.load(file.path());
    }
    egui::Panel::top("menu").show(ui, |ui| menu(ui, viewer));
    if viewer.panel {
        egui::Panel::right("panel").default_size(320.0).size_range(240.0..=560.0).show(ui, |ui| {
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| panel::show(ui, viewer));
        });
    }
    let area = ui.available_rect_before_wrap();
    let pixels = ui.ctx().pixels_per_point();
    viewer.resize(Vec2::new(area.width() * pixels, area.height() * pixels));
    input::handle(ui, area, viewer);
    let texture = picture([viewer.size().x as u32, viewer.size().y as u32], viewer.is_moving() || viewer.is_dragging());
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(texture, area, whole, Color32::WHITE);
    let over = ui.painter().with_clip_rect(area);
    marks(&over, area, viewer);
    hint(&over, area, viewer);
    messages(ui, area, viewer);
    help(ui, viewer);
    file_window::show(ui, viewer);
}

fn menu(ui: &mut Ui, viewer: &mut Viewer) {
    egui::MenuBar::new().ui(ui, |ui| {
        let item = |ui: &mut Ui, text: &str, keys: &str| ui.add(egui::Button::new(text).shortcut_text(keys)).clicked();
        let mut asked = None;
        ui.menu_button("Scene", |ui| {
            if item(ui, "Open...", "Ctrl+O") {
                viewer.dialog.open(false);
            }
            if item(ui, "Save as...", "Ctrl+Shift+S") {
                viewer.dialog.open(true);
            }
            ui.separator();
            let commands = [
                ("Save", "Ctrl+S", Command::Save),
                ("Reload the file of the command line", "Shift+R", Command::LoadGiven),
                ("Load input.txt", "R", Command::LoadInput),
                ("Reset the scene", "Backspace", Command::Reset),
                ("Quit", "Esc", Command::Quit),
            ];
            for (text, keys, command) in commands {
                if item(ui, text, keys) {
                    asked = Some(command);
                }
            }
        });
        ui.menu_button("View", |ui| {
            let commands = [
                ("Reset the camera", "Home", Command::ResetCamera),
                ("Panel", "P", Command::TogglePanel),
                ("Keys", "F1", Command::Help),
            ];
            for (text, keys, command) in commands {
                if item(ui, text, keys) {
                    asked = Some(command);
                }
            }
            ui.separator();
            panel::style_switches(ui, viewer);
        });
        ui.separator();
        asked = asked.or(transport(ui, viewer));
        if let Some(command) = asked {
            viewer.command(command);
        }
    });
}

/// Shows the buttons for start, step, reset and speed.
fn transport(ui: &mut Ui, viewer: &Viewer) -> Option<Command> {
    let mut asked = None;
    let mut button = |ui: &mut Ui, text: &str, about: &str, command: Command| {
        if ui.button(text).on_hover_text(about).clicked() {
            asked = Some(command);
        }
    };
    let start = if viewer.session.running() { "Stop" } else { "Start" };
    button(ui, start, "A", Command::ToggleRunning);
    button(ui, "Step", "S", Command::SingleStep);
    button(ui, "Reset", "Backspace", Command::Reset);
    ui.separator();
    button(ui, "−", "slower: -", Command::ChangeSpeed { faster: false });
    ui.label(format!("{}×", viewer.session.pace.speed()));
    button(ui, "+", "faster: +", Command::ChangeSpeed { faster: true });
    let (text, about) = if viewer.session.pace.real_time {
        ("real time", "steps follow the clock; T switches to one step per frame")
    } else {
        ("one step per frame", "each frame is one step; T switches to real time")
    };
    button(ui, text, about, Command::ToggleRealTime);
    asked
}

/// Returns the position of a point of the scene on the screen, and the length of a unit there, in points.
fn project(viewer: &Viewer, area: Rect, point: Vec3) -> Option<(Pos2, f32)> {
    let axes = viewer.camera.axes();
    let depth = (point - viewer.camera.eye).dot(axes.forward);
    if depth <= viewer.camera.near() {
        return None;
    }
    let ndc = viewer.camera.view_projection(viewer.aspect()).project_point3(point);
    let half = area.size() * 0.5;
    let place = area.center() + egui::vec2(ndc.x * half.x, -ndc.y * half.y);
    Some((place, half.y / ((0.5 * viewer.camera.field_of_view).tan() * depth)))
}

/// Returns the centre and the radius of a body in the state that was read back last.
fn place(simulation: &Simulation, body: Body) -> Option<(Vec3, f32)> {
    let scene = simulation.scene();
    match body {
        Body::Sphere(id) => scene.sphere(id).ok().map(|sphere| (sphere.position, sphere.radius)),
        Body::Rod(id) => {
            let rod = scene.rod(id).ok()?;
            let (one, two) = (scene.sphere(rod.end1).ok()?.position, scene.sphere(rod.end2).ok()?.position);
            Some((one.midpoint(two), 0.5 * one.distance(two) + rod.radius))
        }
        _ => None,
    }
}

/// Draws a ring around the picked body and a line to the held body.
fn marks(painter: &egui::Painter, area: Rect, viewer: &Viewer) {
    let simulation = viewer.session.simulation_ref();
    if let Some((centre, radius)) = viewer.session.picked().and_then(|body| place(simulation, body))
        && let Some((at, scale)) = project(viewer, area, centre)
    {
        painter.circle_stroke(at, radius * scale + 3.0, Stroke::new(2.0, MARK));
    }
    if let Some(held) = viewer.session.held()
        && let Some((centre, _)) = place(simulation, Body::Sphere(held.sphere))
        && let (Some((from, _)), Some((to, _))) = (project(viewer, area, centre), project(viewer, area, held.pointer))
    {
        painter.line_segment([from, to], Stroke::new(2.0, MARK));
        painter.circle_filled(to, 4.0, MARK);
    }
}

/// Draws a hint about the first steps.
fn hint(painter: &egui::Painter, area: Rect, viewer: &Viewer) {
    if !viewer.session.running() && viewer.session.simulation_ref().report().steps == 0 {
        let text = "A starts   ·   F1 shows all keys   ·   drop a scene file here to open it";
        let at = area.center_bottom() - egui::vec2(0.0, 16.0);
        painter.text(at, Align2::CENTER_BOTTOM, text, FontId::proportional(15.0), Color32::from_gray(90));
    }
}

fn messages(ui: &Ui, area: Rect, viewer: &mut Viewer) {
    let shown: Vec<(usize, Level, String)> =
        viewer.session.shown_messages().map(|(index, message)| (index, message.level, message.text.clone())).collect();
    if shown.is_empty() {
        return;
    }
    // Notes disappear without input.
    ui.ctx().request_repaint_after_secs(1.0);
    egui::Area::new(egui::Id::unique("messages"))
        .fixed_pos(area.left_bottom() + egui::vec2(12.0, -12.0))
        .pivot(Align2::LEFT_BOTTOM)
        .show(ui.ctx(), |ui| {
            for (index, level, text) in shown {
                let colour = match level {
                    Level::Note => Color32::from_gray(60),
                    Level::Warning => Color32::from_rgb(0x8a, 0x5a, 0x00),
                    Level::Error => Color32::from_rgb(0xa8, 0x1e, 0x1e),
                };
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width((area.width() - 40.0).clamp(100.0, 640.0));
                    ui.horizontal_wrapped(|ui| {
                        if ui.small_button("×").clicked() {
                            viewer.session.messages.dismiss(index);
                        }
                        ui.label(RichText::new(text).color(colour));
                    });
                });
            }
        });
}

fn help(ui: &Ui, viewer: &mut Viewer) {
    egui::Window::new("Keys").open(&mut viewer.help).resizable(false).collapsible(false).show(ui.ctx(), |ui| {
        let row = |ui: &mut Ui, keys: &str, what: &str| {
            ui.strong(keys);
            ui.label(what);
            ui.end_row();
        };
        egui::Grid::new("keys").num_columns(2).spacing([16.0, 3.0]).show(ui, |ui| {
            controls::TABLE.iter().for_each(|(keys, what)| row(ui, keys, what));
            controls::constant_rows().for_each(|(keys, what)| row(ui, &keys, &what));
        });
    });
}

#[cfg(test)]
#[path = "ui_tests.rs"]
mod tests;
