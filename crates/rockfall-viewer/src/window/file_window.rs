//! Widgets of the file dialog.

use egui::text::{CCursor, CCursorRange};
use egui::{Key, Ui};

use super::dialog::Choice;
use super::viewer::Viewer;

/// Shows the file dialog if it is open, and loads or saves the chosen file.
pub(super) fn show(ui: &Ui, viewer: &mut Viewer) {
    if !viewer.dialog.shown {
        return;
    }
    let (title, verb) = if viewer.dialog.saving { ("Save the present state", "Save") } else { ("Open a scene", "Open") };
    let mut choice = None;
    let mut still_open = true;
    let window = egui::Window::new(title).open(&mut still_open).collapsible(false).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        ui.set_width(480.0);
        choice = if viewer.dialog.question().is_some() { question(ui, viewer) } else { path(ui, viewer, verb) };
    });
    if !still_open {
        viewer.dialog.close();
    }
    if entered(ui) {
        choice = choice.or_else(|| viewer.dialog.confirm());
    }
    if let Some(choice) = choice {
        viewer.choose(&choice);
    }
    if !viewer.dialog.is_shown() {
        // The field is gone, so keys are commands again.
        ui.memory_mut(|memory| {
            if let Some(field) = memory.focused() {
                memory.surrender_focus(field);
            }
        });
    }
}

/// Whether Enter was pressed. Repeats of a key that is kept down do not count, because they would answer the next question.
fn entered(ui: &Ui) -> bool {
    ui.input(|input| {
        input.events.iter().any(|event| {
            matches!(event, egui::Event::Key { key: Key::Enter, pressed: true, repeat: false, modifiers, .. } if modifiers.is_none())
        })
    })
}

/// Asks whether to overwrite a file.
fn question(ui: &mut Ui, viewer: &mut Viewer) -> Option<Choice> {
    let asked = viewer.dialog.question().map(|path| path.display().to_string()).unwrap_or_default();
    let other = viewer.dialog.other_name().unwrap_or_default();
    ui.label(format!("{asked} exists."));
    ui.add_space(6.0);
    let mut choice = None;
    ui.horizontal_wrapped(|ui| {
        let name = other.file_name().unwrap_or_default().to_string_lossy();
        if ui.button(format!("Save as {name} (Enter)")).clicked() {
            choice = viewer.dialog.confirm();
        }
        if ui.button("Overwrite").clicked() {
            choice = viewer.dialog.overwrite();
        }
        if ui.button("Cancel (Esc)").clicked() {
            viewer.dialog.cancel();
        }
    });
    choice
}

/// Shows the field for the path and the files in its folder.
fn path(ui: &mut Ui, viewer: &mut Viewer, verb: &str) -> Option<Choice> {
    let mut choice = None;
    ui.horizontal(|ui| {
        let field = egui::TextEdit::singleline(&mut viewer.dialog.path).desired_width(400.0).hint_text("path of a scene file");
        let mut output = field.show(ui);
        if std::mem::take(&mut viewer.dialog.fresh) {
            output.response.request_focus();
            // What is typed replaces the name of the file.
            let end = viewer.dialog.path.chars().count();
            let name = viewer.dialog.path.chars().rev().take_while(|letter| !std::path::is_separator(*letter)).count();
            let range = CCursorRange::two(CCursor::new(end - name), CCursor::new(end));
            output.state.cursor.set_char_range(Some(range));
            output.state.store(ui.ctx(), output.response.id);
        } else if ui.memory(|memory| memory.focused().is_none()) {
            output.response.request_focus();
        }
        if ui.button(verb).clicked() {
            choice = viewer.dialog.confirm();
        }
    });
    if let Some(error) = &viewer.dialog.error {
        ui.colored_label(egui::Color32::from_rgb(0xa8, 0x1e, 0x1e), error);
    }
    let mut picked = None;
    egui::ScrollArea::vertical().max_height(260.0).auto_shrink([false, true]).show(ui, |ui| {
        if ui.button("../").clicked() {
            picked =
                viewer.dialog.folder().canonicalize().ok().and_then(|folder| folder.parent().map(std::path::PathBuf::from));
        }
        for path in viewer.dialog.list() {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let text = if path.is_dir() { format!("{name}/") } else { name.into_owned() };
            if ui.selectable_label(false, text).clicked() {
                picked = Some(path.clone());
            }
        }
    });
    if let Some(path) = picked {
        if path.is_dir() {
            viewer.dialog.enter(&path);
        } else {
            viewer.dialog.path = path.display().to_string();
            if !viewer.dialog.saving {
                choice = viewer.dialog.confirm();
            }
        }
    }
    ui.label(egui::RichText::new(format!("Enter: {}   Esc: cancel", verb.to_lowercase())).weak());
    choice
}
