//! State of the file dialog: the path, and the scene files in its folder.

use std::path::{Path, PathBuf};

/// State of the file dialog.
#[derive(Clone, Debug, Default)]
pub struct Dialog {
    pub(super) shown: bool,
    pub(super) saving: bool,
    pub(super) path: String,
    /// Folder of the list and its entries.
    listed: Option<(PathBuf, Vec<PathBuf>)>,
}

impl Dialog {
    /// Opens the dialog for a file to save to (`saving`) or to load.
    pub fn open(&mut self, saving: bool) {
        (self.shown, self.saving, self.listed) = (true, saving, None);
    }

    /// Whether the dialog is shown.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// Closes the dialog.
    pub fn close(&mut self) {
        self.shown = false;
    }

    pub(super) fn folder(&self) -> PathBuf {
        let path = Path::new(&self.path);
        let folder = if path.is_dir() { Some(path) } else { path.parent() };
        folder.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
    }

    /// Returns the folders and `.txt` files in the folder of the path.
    pub(super) fn list(&mut self) -> &[PathBuf] {
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
