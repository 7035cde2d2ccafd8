//! The error type.

use std::path::PathBuf;

/// `Result` with the [`Error`] of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a file was not imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[error("{}: {source}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A part of a file is wrong, or a scene cannot have it.
    #[error("{}:{line}: {element}: {message}", file.display())]
    Element {
        /// The file.
        file: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The element, for example `<joint name="knee">`.
        element: String,
        /// What is wrong and what was expected.
        message: String,
    },
    /// The engine refuses the scene.
    #[error("{}: {source}", file.display())]
    Scene {
        /// The file.
        file: PathBuf,
        /// The error of the engine.
        source: rockfall::Error,
    },
}
