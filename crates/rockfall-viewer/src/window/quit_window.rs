//! The question that is asked before unsaved changes are lost.

use egui::Ui;

use super::viewer::Viewer;

/// Shows the question if the user wants to quit with unsaved changes.
pub(super) fn show(ui: &Ui, viewer: &mut Viewer) {
    if !viewer.leaving {
        return;
    }
    let mut still_open = true;
    let window = egui::Window::new("Unsaved changes").open(&mut still_open).collapsible(false).resizable(false);
    window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        ui.label("The scene has changes that are not saved.");
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            if ui.button("Save").clicked() {
                viewer.save_and_leave();
            }
            if ui.button("Quit without saving (Ctrl+Q)").clicked() {
                viewer.quit = true;
            }
            if ui.button("Go on (Esc)").clicked() {
                viewer.leaving = false;
            }
        });
    });
    viewer.leaving &= still_open;
}
