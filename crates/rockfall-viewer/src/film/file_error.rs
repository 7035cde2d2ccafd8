//! Errors that name the file.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::Error;

/// Returns a function that converts an I/O error into an [`Error::File`] for `path`.
pub(super) fn file_error(path: &Path) -> impl Fn(io::Error) -> Error {
    let file: PathBuf = path.to_owned();
    move |source| Error::File { file: file.clone(), source }
}
