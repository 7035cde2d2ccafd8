//! Choosing a file, with nothing but the window itself: a path to type, and the scene texts of its folder.

use std::path::{Path, PathBuf};

use egui::Ui;

use super::viewer::Viewer;

/// A choice of a file.
#[derive(Clone, Debug, Default)]
pub struct Dialog {
    shown: bool,
    saving: bool,
    path: String,
    /// Folder of the list, and what is in it.
    listed: Option<(PathBuf, Vec<PathBuf>)>,
}

impl Dialog {
    /// Asks for a file to open or to save to.
    pub fn open(&mut self, saving: bool) {
        (self.shown, self.saving, self.listed) = (true, saving, None);
    }

    /// Whether it is shown.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// Puts it away.
    pub fn close(&mut self) {
        self.shown = false;
    }

    fn folder(&self) -> PathBuf {
        let path = Path::new(&self.path);
        let folder = if path.is_dir() { Some(path) } else { path.parent() };
        folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
    }

    /// Folders and `.txt` files beside the path.
    fn list(&mut self) -> &[PathBuf] {
        let folder = self.folder();
        if self.listed.as_ref().is_none_or(|(of, _)| *of != folder) {
            let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path());
            let mut entries: Vec<PathBuf> =
                entries.filter(|path| path.is_dir() || path.extension().is_some_and(|end| end == "txt")).collect();
            entries.sort_by_key(|path| (path.is_file(), path.clone()));
            self.listed = Some((folder, entries));
        }
        self.listed.as_ref().map_or(&[], |(_, entries)| entries)
    }
}

/// Shows the dialog, if it is open, and does what it was asked for.
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
                egui::TextEdit::singleline(&mut viewer.dialog.path).desired_width(380.0).hint_text("path of a scene text"),
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
