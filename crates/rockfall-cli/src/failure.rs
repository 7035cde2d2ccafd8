//! Errors of commands and their exit codes.

use std::fmt::Display;
use std::io;
use std::path::Path;

use rockfall::{Error, Scene};

/// Exit code of a command that is ended by a signal, as in shells for Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// Reason why a command ends early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage or a bad scene: exit code 2.
    Usage(String),
    /// The run failed: exit code 1.
    Run(String),
    /// A signal ended the run, and its results so far are written: exit code 130.
    Interrupted(String),
    /// Another process of the run reports the failure: exit code 0, because `mpirun` may end all processes when one has another code.
    #[cfg(feature = "mpi")]
    Elsewhere,
    /// The reader of standard output has closed it, which is not an error: exit code 0.
    ClosedPipe,
}

impl Failure {
    /// Creates a failure by wrong usage or a bad scene.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// Creates a failure for a file that could not be written.
    pub(crate) fn file(path: &Path, error: &io::Error) -> Self {
        Self::Run(format!("{}: cannot be written: {error}", path.display()))
    }
}

impl Failure {
    /// A failure that names a sphere as the scene file does.
    pub(crate) fn of(error: Error, scene: &Scene) -> Self {
        match error {
            Error::NonFinite { .. } => Self::Run(error.describe(scene)),
            error => error.into(),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Invalid { .. }
            | Error::UnknownSetting { .. }
            | Error::UnknownName { .. }
            | Error::TooManyObjects { .. }
            | Error::PictureSize { .. } => Self::usage(error),
            _ => Self::Run(error.to_string()),
        }
    }
}
