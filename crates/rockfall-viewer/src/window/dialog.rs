//! State of the file dialog: the path, the scene files in its folder, and the question whether to overwrite a file.

use std::path::{Path, PathBuf};

use super::new_name::new_name;

/// State of the file dialog.
#[derive(Clone, Debug, Default)]
pub struct Dialog {
    pub(super) shown: bool,
    pub(super) saving: bool,
    /// Whether it was opened since the last frame, so that its field needs the focus.
    pub(super) fresh: bool,
    /// The path in the field.
    pub path: String,
    /// Why the file could not be opened or saved.
    pub(super) error: Option<String>,
    /// The existing file that the user is asked about.
    question: Option<PathBuf>,
    /// Folder of the list and its entries.
    listed: Option<(PathBuf, Vec<PathBuf>)>,
}

/// What the user chose in the dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Open this scene file.
    Open(PathBuf),
    /// Write this file, even if it exists.
    Save(PathBuf),
}

impl Dialog {
    /// Opens the dialog for a file to save to (`saving`) or to load, with a path to start from.
    pub fn open(&mut self, saving: bool, path: String) {
        *self = Self { shown: true, saving, fresh: true, path, ..Self::default() };
    }

    /// Whether the dialog is shown.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// The existing file that the user is asked about.
    pub fn question(&self) -> Option<&Path> {
        self.question.as_deref()
    }

    /// Closes the question if there is one, else the dialog.
    pub fn cancel(&mut self) {
        if self.question.take().is_none() {
            self.shown = false;
        }
    }

    /// Closes the dialog.
    pub fn close(&mut self) {
        (self.shown, self.question) = (false, None);
    }

    /// Keeps the dialog open with an error message.
    pub fn refuse(&mut self, error: impl Into<String>) {
        (self.shown, self.error, self.listed) = (true, Some(error.into()), None);
    }

    /// Returns the name that [`Dialog::confirm`] saves to while the question is shown: a file that does not exist.
    pub fn other_name(&self) -> Option<PathBuf> {
        let asked = self.question.as_deref()?;
        let stem = asked.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let extension = asked.extension().unwrap_or_default().to_string_lossy().into_owned();
        Some(new_name(asked.parent().unwrap_or(Path::new("")), &stem, &extension))
    }

    /// Confirms the path (Enter): returns what to do, or `None` if there is nothing to do yet. A folder is entered. A file to
    /// save gets the extension `.txt` if it has none. If it exists, the user is asked. To confirm that question saves to a new
    /// name, so that no file is overwritten by pressing Enter twice.
    pub fn confirm(&mut self) -> Option<Choice> {
        self.error = None;
        if let Some(other) = self.other_name() {
            return Some(Choice::Save(other));
        }
        let path = PathBuf::from(self.path.trim());
        if path.as_os_str().is_empty() {
            return None;
        }
        if path.is_dir() {
            self.enter(&path);
            return None;
        }
        if !self.saving {
            return Some(Choice::Open(path));
        }
        if path.file_name().is_none() || self.path.trim().ends_with(std::path::is_separator) {
            self.refuse("the name of a file is missing");
            return None;
        }
        let path = if path.extension().is_none() { path.with_extension("txt") } else { path };
        if path.exists() {
            self.question = Some(path);
            return None;
        }
        Some(Choice::Save(path))
    }

    /// Overwrites the file of the question.
    pub fn overwrite(&mut self) -> Option<Choice> {
        self.question.take().map(Choice::Save)
    }

    /// Shows the content of a folder. When saving, the name of the file stays.
    pub(super) fn enter(&mut self, folder: &Path) {
        let name = match Path::new(&self.path).file_name() {
            Some(name) if self.saving && !Path::new(&self.path).is_dir() => folder.join(name),
            _ => folder.join(""),
        };
        self.path = name.display().to_string();
        self.listed = None;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(path: &Path, saving: bool) -> Dialog {
        let mut dialog = Dialog::default();
        dialog.open(saving, path.display().to_string());
        dialog
    }

    #[test]
    fn an_existing_file_is_overwritten_only_when_that_is_chosen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.txt");
        std::fs::write(&path, "kept").unwrap();
        let mut dialog = at(&path, true);
        assert_eq!((dialog.confirm(), dialog.question()), (None, Some(path.as_path())));
        // A second Enter saves to another name.
        assert_eq!(dialog.clone().confirm(), Some(Choice::Save(folder.path().join("mine-1.txt"))));
        assert_eq!(dialog.clone().overwrite(), Some(Choice::Save(path)));
        dialog.cancel();
        assert!(dialog.is_shown() && dialog.question().is_none());
        dialog.cancel();
        assert!(!dialog.is_shown());
    }

    #[test]
    fn a_new_file_gets_the_extension_of_scenes() {
        let folder = tempfile::tempdir().unwrap();
        let confirmed = |name: &str| at(&folder.path().join(name), true).confirm();
        assert_eq!(confirmed("new"), Some(Choice::Save(folder.path().join("new.txt"))));
        assert_eq!(confirmed("new.scene"), Some(Choice::Save(folder.path().join("new.scene"))));
        assert_eq!(at(Path::new("  "), true).confirm(), None);
    }

    #[test]
    fn folders_are_entered() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("b.txt"), "").unwrap();
        for saving in [false, true] {
            let mut dialog = at(folder.path(), saving);
            assert_eq!(dialog.confirm(), None);
            assert!(dialog.is_shown() && dialog.list() == [folder.path().join("b.txt")]);
        }
        let mut dialog = at(Path::new("bridge-1.txt"), true);
        dialog.enter(folder.path());
        assert_eq!(dialog.confirm(), Some(Choice::Save(folder.path().join("bridge-1.txt"))));
    }
}
