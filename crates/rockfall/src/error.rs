//! The one error type of the library.

use std::fmt;
use std::path::PathBuf;

/// `Result` with the library's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Everything that can go wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of an object or a setting has a value it must not have.
    #[error("{field}: {value} is not allowed, expected {expected}")]
    Invalid {
        /// What is wrong, for example `sphere.mass`.
        field: &'static str,
        /// The value that was given.
        value: String,
        /// What would have been right.
        expected: &'static str,
    },
    /// A handle refers to an object that was removed, or to one of another scene.
    #[error("stale handle: the {kind} it refers to is not in the scene (removed, or of another scene)")]
    StaleHandle {
        /// Kind of the object, for example `sphere`.
        kind: &'static str,
    },
    /// A setting with this name does not exist.
    #[error("unknown setting {}, expected one of: {expected}", quoted(name))]
    UnknownSetting {
        /// The name that was given.
        name: String,
        /// All names there are.
        expected: String,
    },
    /// More objects than the engine can number.
    #[error("{count} objects are too many, at most {limit} can be numbered")]
    TooManyObjects {
        /// Objects in the scene.
        count: usize,
        /// The most there may be.
        limit: usize,
    },
    /// A line of a scene file is wrong.
    #[error("{}:{line}: {field}: {message}", file.display())]
    SceneLine {
        /// The file, or a name for where the text came from.
        file: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The field of the line, for example `S mass`.
        field: String,
        /// What is wrong and what was expected.
        message: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A file is no checkpoint that a simulation can go on from.
    #[error("{}: not a usable checkpoint: {reason}", file.display())]
    Checkpoint {
        /// The file, or a name for where the bytes came from.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// No graphics adapter could be used.
    #[error("no usable GPU: {0}")]
    NoAdapter(String),
    /// The device refused, was lost or ran out of memory.
    #[error("GPU: {0}")]
    Device(String),
    /// The scene does not fit the limits of the device, or of the engine.
    #[error(
        "the scene does not fit: {what} would take {needed} bytes, the limit is {limit}; use fewer objects or, where the limit \
         is the GPU's, a device with a higher max_storage_buffers_per_shader_stage (what is larger than one binding takes \
         several) or --backend cpu"
    )]
    DeviceLimit {
        /// The buffer that is too large.
        what: &'static str,
        /// Bytes needed.
        needed: u64,
        /// Bytes there may be.
        limit: u64,
    },
    /// A body's state stopped being finite.
    #[error(
        "sphere {sphere} stopped being finite in step {step} ({stage}); a spring or the contact force may be too stiff for the time step, `rockfall check` tells"
    )]
    NonFinite {
        /// Index of the sphere, in order of addition.
        sphere: usize,
        /// The step, from 1.
        step: u64,
        /// The place in the step.
        stage: BadStage,
    },
    /// A step was run again so often that it cannot succeed.
    #[error("step {step} was void {attempts} times in a row: {reason}; a shorter time step may help")]
    Stuck {
        /// The step, from 1.
        step: u64,
        /// How often it was tried.
        attempts: u32,
        /// Why it was void.
        reason: String,
    },
}

/// Characters of a quoted text that are shown.
const SHOWN: usize = 40;

/// What somebody wrote, for a message: quoted, cut where it is long, and without characters that a terminal would obey.
pub(crate) fn quoted(text: &str) -> String {
    let mut shown = String::from("'");
    for (count, character) in text.chars().enumerate() {
        if count == SHOWN {
            shown.push_str("...");
            break;
        }
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown.push('\'');
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_are_short_and_harmless() {
        assert_eq!(quoted("1,5 \u{f6}"), "'1,5 \u{f6}'");
        assert_eq!(quoted("\u{1b}[2J\u{9b}\r"), "'\\u{1b}[2J\\u{9b}\\r'");
        assert_eq!(quoted(&"\u{fffd}".repeat(40)).chars().count(), 42);
        assert_eq!(quoted(&"x".repeat(1000)), format!("'{}...'", "x".repeat(40)));
    }
}

/// The place in a step at which a body stopped being finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum BadStage {
    /// `apply_collisions`.
    Collisions = 0,
    /// The first force evaluation (the only one of symplectic Euler); 2, 3 and 4 follow.
    Forces1 = 1,
    /// The second force evaluation of RK4.
    Forces2 = 2,
    /// The third force evaluation of RK4.
    Forces3 = 3,
    /// The fourth force evaluation of RK4.
    Forces4 = 4,
}

impl fmt::Display for BadStage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Collisions => "in its collisions",
            Self::Forces1 => "in its first force evaluation",
            Self::Forces2 => "in its second force evaluation",
            Self::Forces3 => "in its third force evaluation",
            Self::Forces4 => "in its fourth force evaluation",
        })
    }
}

impl BadStage {
    /// The stage with this number.
    pub(crate) fn from_number(number: u32) -> Self {
        match number {
            0 => Self::Collisions,
            1 => Self::Forces1,
            2 => Self::Forces2,
            3 => Self::Forces3,
            _ => Self::Forces4,
        }
    }
}
