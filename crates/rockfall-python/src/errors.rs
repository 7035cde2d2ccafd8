//! Converts the errors of the library to Python exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyLookupError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rockfall::Error;

create_exception!(rockfall, SimulationError, PyRuntimeError, "A simulation or a device failed.");

/// Converts an error of the library. Its message stays the same.
pub(crate) fn raise(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Invalid { .. }
        | Error::UnknownSetting { .. }
        | Error::TooManyObjects { .. }
        | Error::PictureSize { .. }
        | Error::SceneLine { .. }
        | Error::Checkpoint { .. }
        | Error::Law { .. } => PyValueError::new_err(text),
        Error::StaleHandle { .. } => PyLookupError::new_err(text),
        // The kind chooses the exception: FileNotFoundError, PermissionError and others.
        Error::File { source, .. } => std::io::Error::new(source.kind(), text).into(),
        _ => SimulationError::new_err(text),
    }
}

/// Converts an error of a step, in which a law that the program gave may fail.
pub(crate) fn raise_in_step(error: Error) -> PyErr {
    match error {
        Error::Law { .. } => SimulationError::new_err(error.to_string()),
        other => raise(other),
    }
}

/// Converts the error of a result.
pub(crate) trait Raise<T> {
    /// Converts the error.
    fn or_raise(self) -> PyResult<T>;
}

impl<T> Raise<T> for rockfall::Result<T> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(raise)
    }
}
