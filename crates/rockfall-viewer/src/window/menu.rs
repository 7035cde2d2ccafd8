//! The menu.

use egui::Ui;

use super::controls::{Command, Controls};
use super::viewer::Viewer;
use super::{overlay, panel};
use crate::camera::Direction;
use crate::film::Format;

/// Shows the menu and executes what is chosen.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    egui::MenuBar::new().ui(ui, |ui| {
        let mut asked = None;
        ui.menu_button("Scene", |ui| asked = asked.or(scene(ui, viewer)));
        ui.menu_button("Edit", |ui| asked = asked.or(edit(ui, viewer)));
        ui.menu_button("View", |ui| asked = asked.or(view(ui, viewer)));
        if ui.button("Keys").on_hover_text("F1").clicked() {
            asked = Some(Command::Help);
        }
        if let Some(command) = asked {
            viewer.command(command);
        }
    });
}

/// Shows entries with their keys, and returns the command of the chosen one.
fn entries(ui: &mut Ui, entries: &[(&str, &str, Command)]) -> Option<Command> {
    let mut asked = None;
    for (text, keys, command) in entries {
        if ui.add(egui::Button::new(*text).shortcut_text(*keys)).clicked() {
            asked = Some(*command);
        }
    }
    asked
}

fn scene(ui: &mut Ui, viewer: &mut Viewer) -> Option<Command> {
    let mut asked = entries(
        ui,
        &[
            ("Open...", "Ctrl+O", Command::Open),
            ("Save", "Ctrl+S", Command::Save),
            ("Save as...", "Ctrl+Shift+S", Command::SaveAs),
        ],
    );
    ui.separator();
    asked = asked.or(entries(ui, &[("Save the picture", "F12", Command::Screenshot)]));
    recording(ui, viewer);
    ui.separator();
    asked.or(entries(
        ui,
        &[
            ("Reload the file of the command line", "Shift+R", Command::LoadGiven),
            ("Load input.txt", "R", Command::LoadInput),
            ("Reset the scene", "Backspace", Command::Reset),
            ("Start again", "I", Command::Restart),
            ("Quit", "Ctrl+Q", Command::Quit),
        ],
    ))
}

/// Shows the entries that start or end a recording.
pub(super) fn recording(ui: &mut Ui, viewer: &mut Viewer) {
    if viewer.capture.is_recording() {
        if ui.button("End the recording").clicked() {
            viewer.stop_recording();
        }
        return;
    }
    for (text, format) in [("Record a GIF", Format::Gif), ("Record an MP4 (needs ffmpeg)", Format::Mp4)] {
        if ui.button(text).clicked() {
            viewer.start_recording(format);
        }
    }
}

fn edit(ui: &mut Ui, viewer: &Viewer) -> Option<Command> {
    let [undo, redo] = viewer.session.can_undo();
    let mut asked = None;
    let rows = [("Undo", "Ctrl+Z", Command::Undo, undo), ("Redo", "Ctrl+Y", Command::Redo, redo)];
    for (text, keys, command, enabled) in rows {
        if ui.add_enabled(enabled, egui::Button::new(text).shortcut_text(keys)).clicked() {
            asked = Some(command);
        }
    }
    ui.separator();
    asked.or(entries(ui, &[("Throw a sphere", "L", Command::Throw)]))
}

fn view(ui: &mut Ui, viewer: &mut Viewer) -> Option<Command> {
    let frame = if viewer.controls == Controls::Standard { "F" } else { "Shift+F" };
    let follow = if viewer.is_following() { "Follow another body, or none" } else { "Follow the picked body" };
    let asked = entries(
        ui,
        &[
            ("Show the whole scene", frame, Command::FrameAll),
            ("From the front", "1", Command::LookFrom(Direction::Front)),
            ("From the side", "2", Command::LookFrom(Direction::Side)),
            ("From the top", "3", Command::LookFrom(Direction::Top)),
            ("Along the diagonal", "4", Command::LookFrom(Direction::Iso)),
            ("Reset the camera", "Home", Command::ResetCamera),
            (follow, "W", Command::Follow),
            ("Panel", "P", Command::TogglePanel),
            ("Messages", "", Command::ToggleMessages),
            ("Keys and mouse", "F1", Command::Help),
        ],
    );
    ui.separator();
    ui.radio_value(&mut viewer.controls, Controls::Standard, "Standard mouse");
    ui.radio_value(&mut viewer.controls, Controls::Thesis, "Mouse of the thesis");
    ui.separator();
    panel::style_switches(ui, viewer);
    ui.separator();
    overlay::switches(ui, viewer);
    asked
}
