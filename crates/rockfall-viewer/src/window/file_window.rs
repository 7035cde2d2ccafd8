//! Widgets of the file dialog.

use std::path::PathBuf;

use egui::Ui;

use super::viewer::Viewer;

/// Shows the file dialog if it is open, and loads or saves the chosen file.
pub(super) fn show(ui: &Ui, viewer: &mut Viewer) {
    if !viewer.dialog.shown {
        return;
    }
    let (title, verb) = if viewer.dialog.saving { ("Save the present state", "Save") } else { ("Open a scene", "Open") };
    let mut chosen = None;
    let mut still_open = true;
    egui::Window::new(title).open(&mut still_open).collapsible(false).default_width(460.0).show(ui.ctx(), |ui| {
        ui.horizontal(|ui| {
            let field = ui.add(
                egui::TextEdit::singleline(&mut viewer.dialog.path).desired_width(380.0).hint_text("path of a scene file"),
            );
            if ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if ui.button(verb).clicked() || entered {
                chosen = Some(PathBuf::from(&viewer.dialog.path));
            }
        });
        let mut picked = None;
        egui::ScrollArea::vertical().max_height(260.0).auto_shrink([false, true]).show(ui, |ui| {
            if ui.button("../").clicked() {
                picked = viewer.dialog.folder().canonicalize().ok().and_then(|folder| folder.parent().map(PathBuf::from));
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
            viewer.dialog.path = path.display().to_string();
            if path.is_file() && !viewer.dialog.saving {
                chosen = Some(path);
            }
        }
    });
    viewer.dialog.shown &= still_open;
    if let Some(path) = chosen.filter(|path| !path.as_os_str().is_empty()) {
        viewer.dialog.close();
        if viewer.dialog.saving {
            viewer.save_as = path;
            viewer.save();
        } else {
            viewer.load(&path);
        }
    }
}
