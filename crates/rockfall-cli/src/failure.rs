//! Why a command ends early, and with which exit code.

use std::fmt::Display;
use std::io;
use std::path::Path;

use rockfall::Error;

/// Exit code of a command that was ended by a signal, as shells give it for Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// A command's error.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage or a bad scene: exit code 2.
    Usage(String),
    /// The run failed: exit code 1.
    Run(String),
    /// A signal ended the run, what it computed is written: exit code 130.
    Interrupted(String),
    /// Nobody reads standard output any more, which is no error: exit code 0.
    ClosedPipe,
}

impl Failure {
    /// Wrong usage or a bad scene.
    pub(crate) fn usage(message: impl Display) -> Self {
        Self::Usage(message.to_string())
    }

    /// A file that could not be written.
    pub(crate) fn file(path: &Path, error: &io::Error) -> Self {
        Self::Run(format!("{}: cannot be written: {error}", path.display()))
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Invalid { .. } | Error::UnknownSetting { .. } | Error::TooManyObjects { .. } => Self::usage(error),
            _ => Self::Run(error.to_string()),
        }
    }
}
