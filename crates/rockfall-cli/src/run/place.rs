//! Paths of output files in the note of a checkpoint. They are relative to its folder where they lie below it, so that a folder can be
//! moved or copied with its runs. A checkpoint may come from a stranger, so a resumed run writes nowhere else unless it is told to.

use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

use rockfall_trajectory::Format;
use serde::{Deserialize, Serialize};

/// The path of an output file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Stored", into = "Stored")]
pub(crate) struct Place(pub(crate) PathBuf);

/// A path as JSON has it: a text, or the bytes of a path that is not UTF-8.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Stored {
    Text(String),
    Bytes(Vec<u8>),
}

impl From<Place> for Stored {
    fn from(Place(path): Place) -> Self {
        match path.into_os_string().into_string() {
            Ok(text) => Self::Text(text),
            Err(path) => Self::Bytes(path.into_encoded_bytes()),
        }
    }
}

impl From<Stored> for Place {
    fn from(stored: Stored) -> Self {
        match stored {
            Stored::Text(text) => Self(text.into()),
            Stored::Bytes(bytes) => Self(of_bytes(bytes).into()),
        }
    }
}

#[cfg(unix)]
fn of_bytes(bytes: Vec<u8>) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes)
}

/// Names that are not UTF-8 do not occur elsewhere, apart from halves of characters.
#[cfg(not(unix))]
fn of_bytes(bytes: Vec<u8>) -> OsString {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

impl Place {
    /// The path as a checkpoint in a folder stores it: relative if it lies below the folder, otherwise absolute.
    pub(super) fn stored_in(&self, folder: &Path) -> Self {
        let path = whole(&self.0);
        Self(path.strip_prefix(resolved(folder)).map(Path::to_owned).unwrap_or(path))
    }

    /// The path that a checkpoint in a folder stores.
    pub(super) fn found_in(&self, folder: &Path) -> Self {
        Self(folder.join(&self.0))
    }
}

/// The folder of a file.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// Whether an output is a regular file or a new one below a folder, and so are the frames of a series. Links are followed.
pub(super) fn is_below(path: &Path, folder: &Path) -> bool {
    let place = whole(path);
    let is_series = Format::of(path) == Some(Format::Vtp);
    let frames = is_series.then(|| place.with_extension(""));
    let folder = resolved(folder);
    let is_inside = |path: &Path| {
        // A link to nothing is replaced by the file. A folder that is missing is found out when the file is opened.
        let end = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        end.starts_with(&folder) && !end.components().any(|part| part == Component::ParentDir)
    };
    let is_special = place.metadata().is_ok_and(|found| !found.is_file());
    !is_special && is_inside(&place) && frames.as_deref().is_none_or(is_inside)
}

/// Absolute path of a file, whether or not it exists, with the links of its folder resolved.
pub(super) fn whole(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let place = path.parent().and_then(|folder| Some(folder.canonicalize().ok()?.join(path.file_name()?)));
    place.unwrap_or(path)
}

/// Absolute path of a folder with its links resolved.
fn resolved(folder: &Path) -> PathBuf {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn paths_below_a_folder_are_stored_relative_to_it() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        fs::create_dir_all(run.join("sub")).unwrap();
        for (path, stored) in [("run/a.csv", "a.csv"), ("run/sub/../b.csv", "b.csv"), ("run/sub/c.csv", "sub/c.csv")] {
            let place = Place(folder.path().join(path)).stored_in(&run);
            assert_eq!(place, Place(stored.into()));
            assert_eq!(whole(&place.found_in(&run).0), whole(&folder.path().join(path)));
            assert!(is_below(&place.found_in(&run).0, &run), "{path}");
        }
        let outside = Place(folder.path().join("a.csv")).stored_in(&run);
        assert!(outside.0.is_absolute(), "{outside:?}");
        for path in ["../a.csv", "sub/../../a.csv", "none/../../a.csv", "sub"] {
            assert!(!is_below(&run.join(path), &run), "{path}");
        }
        assert!(!is_below(&outside.0, &run));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        fs::create_dir_all(run.join("sub")).unwrap();
        for name in ["a.csv", "run/b.csv"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        symlink(folder.path().join("a.csv"), run.join("out.csv")).unwrap();
        symlink(folder.path(), run.join("up")).unwrap();
        symlink(folder.path(), run.join("film")).unwrap();
        symlink(run.join("b.csv"), run.join("in.csv")).unwrap();
        for (name, expected) in
            [("out.csv", false), ("up/c.csv", false), ("film.pvd", false), ("in.csv", true), ("up.csv", true)]
        {
            assert_eq!(is_below(&run.join(name), &run), expected, "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn paths_that_are_not_utf_8_are_stored_bit_by_bit() {
        let place = Place(of_bytes(b"run\xff/a.csv".to_vec()).into());
        let text = serde_json::to_string(&place).unwrap();
        assert_eq!(serde_json::from_str::<Place>(&text).unwrap(), place);
        assert_eq!(serde_json::to_string(&Place("a.csv".into())).unwrap(), "\"a.csv\"");
    }
}
