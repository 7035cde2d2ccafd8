//! Errors of output files.

use rockfall::Error;

use crate::failure::Failure;

/// Error for an output of the earlier run that cannot be continued.
pub(super) fn lost(error: &Error, option: &str) -> Failure {
    Failure::usage(format!("{error}; --resume cannot continue this file: give another {option}"))
}

/// Converts errors of the library, so that a file that cannot be written is reported with its name.
pub(super) fn written<T>(result: rockfall::Result<T>) -> Result<T, Failure> {
    result.map_err(|error| match error {
        Error::File { file, source } => Failure::file(&file, &source),
        error => error.into(),
    })
}
