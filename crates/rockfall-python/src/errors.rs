//! Converts the errors of the library to Python exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyKeyError, PyLookupError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rockfall::Error;

create_exception!(rockfall, SimulationError, PyRuntimeError, "A simulation or a device failed.");

/// Converts an error of an import.
pub(crate) fn raise_import(error: rockfall_import::Error) -> PyErr {
    let text = error.to_string();
    match error {
        rockfall_import::Error::File { source, .. } => std::io::Error::new(source.kind(), text).into(),
        _ => PyValueError::new_err(text),
    }
}

/// Converts an error of the library. Its message has the words of Python.
pub(crate) fn raise(error: Error) -> PyErr {
    // Errors of a scene text speak of its lines.
    let text = match &error {
        Error::SceneLine { .. } => error.to_string(),
        _ => in_python(&error.to_string()),
    };
    match error {
        Error::Invalid { .. }
        | Error::UnknownSetting { .. }
        | Error::TooManyObjects { .. }
        | Error::PictureSize { .. }
        | Error::SceneLine { .. }
        | Error::Mesh { .. }
        | Error::Checkpoint { .. }
        | Error::Law { .. } => PyValueError::new_err(text),
        Error::UnknownName { .. } => PyKeyError::new_err(text),
        Error::StaleHandle { .. } => PyLookupError::new_err(text),
        // The kind chooses the exception: FileNotFoundError, PermissionError and others.
        Error::File { source, .. } => std::io::Error::new(source.kind(), text).into(),
        _ => SimulationError::new_err(text),
    }
}

/// Phrases of messages, and what they are in Python.
const PHRASES: [(&str, &str); 4] = [
    ("a line `@name NAME` gives one", "`name=` of the `add` methods gives one"),
    ("`rockfall devices`", "`rockfall.devices()`"),
    ("set friction in its @pair line", "give `friction` to `scene.set_pair`"),
    ("set precision double", "`scene.settings.precision = \"double\"`"),
];

/// A message with the words of Python in place of those of the scene text and the command line: `scene.settings.gravity = 1` for
/// `set gravity 1`, and `backend="cpu"` for `--backend cpu`.
pub(crate) fn in_python(text: &str) -> String {
    let found = options(&settings(text));
    PHRASES.iter().fold(found, |found, (words, python)| found.replace(words, python))
}

fn value(text: &str) -> String {
    match text {
        "on" => "True".to_owned(),
        "off" => "False".to_owned(),
        number if number.parse::<f64>().is_ok() => number.to_owned(),
        name => format!("\"{name}\""),
    }
}

fn settings(text: &str) -> String {
    let mut parts = text.split("`set ");
    let mut found = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let read = part.split_once('`').and_then(|(inner, rest)| Some((inner.split_once(' ')?, rest)));
        match read {
            Some(((name, given), rest)) => found += &format!("`scene.settings.{name} = {}`{rest}", value(given)),
            None => found += &format!("`set {part}"),
        }
    }
    found
}

fn options(text: &str) -> String {
    let mut parts = text.split("--");
    let mut found = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let given =
            part.split_once(' ').filter(|(name, _)| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_lowercase()));
        match given {
            Some((name, rest)) => {
                let end = rest.find([' ', ',', ';', '`', ')']).unwrap_or(rest.len());
                found += &format!("{name}={}{}", value(&rest[..end]), &rest[end..]);
            }
            None => found += &format!("--{part}"),
        }
    }
    found
}

/// Converts an error of a step, in which a law that the program gave may fail.
pub(crate) fn raise_in_step(error: Error) -> PyErr {
    match error {
        Error::Law { .. } => SimulationError::new_err(in_python(&error.to_string())),
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
