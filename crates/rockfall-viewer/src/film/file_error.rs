//! Errors of files.

use std::io;
use std::path::{Path, PathBuf};

use rockfall::Error;

/// Returns what turns an I/O error into an error that names the file.
pub(super) fn file_error(path: &Path) -> impl Fn(io::Error) -> Error {
    let file: PathBuf = path.to_owned();
    move |source| Error::File { file: file.clone(), source }
}
