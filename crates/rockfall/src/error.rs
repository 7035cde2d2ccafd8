//! The error type of the library.

use std::fmt;
use std::path::PathBuf;

/// `Result` with the library's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The errors of the library.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of an object or a setting has a value that is not allowed.
    #[error("{field}: {} is not allowed, expected {expected}", shown(value))]
    Invalid {
        /// Name of the field, for example `sphere.mass`.
        field: &'static str,
        /// The value that was given.
        value: String,
        /// Description of the allowed values.
        expected: &'static str,
    },
    /// A handle refers to an object that was removed, or that belongs to another scene.
    #[error("the {kind} is not in the scene: it was removed, or it belongs to another scene")]
    StaleHandle {
        /// Kind of the object, for example `sphere`.
        kind: &'static str,
    },
    /// A setting with this name does not exist.
    #[error("unknown setting {}{}, expected one of: {expected}", quoted(name), suggestion(name, expected))]
    UnknownSetting {
        /// The name that was given.
        name: String,
        /// All known names.
        expected: String,
    },
    /// No object of the scene has this name.
    #[error("no object has the name {}: {hint}", quoted(name))]
    UnknownName {
        /// The name that was given.
        name: String,
        /// A similar name, or the names that are known.
        hint: String,
    },
    /// The scene has more objects than the engine supports.
    #[error("{count} objects are too many, the limit is {limit}")]
    TooManyObjects {
        /// Number of objects in the scene.
        count: usize,
        /// Maximum number of objects.
        limit: usize,
    },
    /// A picture has a side of 0 pixels, or one that is larger than the device allows.
    #[error("a picture of {width}x{height} pixels cannot be drawn, expected sides from 1 to {limit}")]
    PictureSize {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Largest side in pixels.
        limit: u32,
    },
    /// A line of a scene file is not valid.
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
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file is not a triangle mesh that can be read.
    #[error("{}{place}: {message}", file.display())]
    Mesh {
        /// The file, or a name for where the bytes came from.
        file: PathBuf,
        /// The place in the file.
        place: MeshPlace,
        /// What is wrong and what was expected.
        message: String,
    },
    /// A file is not a checkpoint that a simulation can be resumed from.
    #[error("{}: not a usable checkpoint: {reason}", file.display())]
    Checkpoint {
        /// The file, or a name for where the bytes came from.
        file: PathBuf,
        /// The reason why it cannot be used.
        reason: String,
    },
    /// No graphics adapter could be used.
    #[error("no usable GPU: {0}")]
    NoAdapter(String),
    /// The device reported an error, was lost or ran out of memory.
    #[error("GPU: {0}")]
    Device(String),
    /// The scene exceeds a limit of the device or of the engine.
    #[error(
        "the scene does not fit: {what} would take {needed} bytes, the limit is {limit}; use fewer objects, or fewer in one \
         place, or, if the limit is that of the GPU, a device with a higher max_storage_buffers_per_shader_stage (a buffer larger than one \
         binding takes several) or --backend cpu"
    )]
    DeviceLimit {
        /// The buffer that is too large.
        what: &'static str,
        /// Bytes needed.
        needed: u64,
        /// Maximum number of bytes.
        limit: u64,
    },
    /// The state of a body stopped being finite.
    #[error("{}", non_finite(&format!("sphere number {sphere}"), *step, *stage, false))]
    NonFinite {
        /// Index of the sphere, in order of addition.
        sphere: usize,
        /// The step, from 1.
        step: u64,
        /// The place in the step.
        stage: BadStage,
    },
    /// A process of several that share a scene has failed.
    #[cfg(any(test, feature = "mpi"))]
    #[error("{0}")]
    Cluster(String),
    /// The impulses on a network of fixed-length rods could not be solved.
    #[error(
        "step {step}: a collision of a network of fixed-length rods could not be solved: rods and masses that differ less, smaller \
         networks or `--backend cpu`, which solves in double precision, may help"
    )]
    Networks {
        /// The step, from 1.
        step: u64,
    },
    /// A law that the program gave is not valid, or gave a result that is not finite.
    #[error("law {}{}: {}{}", quoted(law), place(*line, *column), shortened(message, LONGEST), excerpt(text, *column))]
    Law {
        /// Name of the law.
        law: String,
        /// Line of its WGSL text, from 1; 0 if the error is not about a line.
        line: usize,
        /// Column in characters, from 1; 0 if the error is about a whole line.
        column: usize,
        /// The line of the text.
        text: String,
        /// What is wrong.
        message: String,
    },
    /// A step was rejected too many times in a row.
    #[error("step {step} was rejected {attempts} times in a row: {reason}; a shorter time step may help")]
    Stuck {
        /// The step, from 1.
        step: u64,
        /// Number of attempts.
        attempts: u32,
        /// The reason why the step was rejected.
        reason: String,
    },
}

/// The place in a mesh file that an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshPlace {
    /// The whole file.
    Whole,
    /// A line of a text, from 1.
    Line(usize),
    /// Offset of a byte from the beginning of the file.
    Byte(usize),
}

impl fmt::Display for MeshPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(f, ":{line}"),
            Self::Byte(offset) => write!(f, ", byte {offset}"),
        }
    }
}

/// The message of [`Error::NonFinite`].
pub(crate) fn non_finite(sphere: &str, step: u64, stage: BadStage, has_joints: bool) -> String {
    let cause = if has_joints { "a joint, a spring or the contact force" } else { "a spring or the contact force" };
    format!(
        "{sphere} stopped being finite in step {step} ({stage}); {cause} may be too stiff for the time step, see `rockfall check`"
    )
}

/// Maximum number of characters of a quoted text.
const SHOWN: usize = 40;
/// Maximum number of characters of a value, and of a message about a law, which may list names or quote the text.
const LONGEST: usize = 300;
/// Maximum number of characters of a line of a law in a message.
const WIDE: usize = 100;

/// Quotes the user's text for a message: shortened if it is long, and with control characters escaped, because a terminal would
/// obey them.
pub(crate) fn quoted(text: &str) -> String {
    format!("'{}'", shortened(text, SHOWN))
}

/// A value for a message. It may hold names that the user gave, and explain itself in words.
pub(crate) fn shown(value: &str) -> String {
    shortened(value, LONGEST)
}

/// The first `most` characters of a text that may hold words of the user, with control characters escaped.
fn shortened(text: &str, most: usize) -> String {
    let mut shown = String::new();
    for (count, character) in text.chars().enumerate() {
        if count == most {
            shown.push_str("...");
            break;
        }
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown
}

/// The place of an error in the text of a law.
fn place(line: usize, column: usize) -> String {
    match (line, column) {
        (0, _) => String::new(),
        (_, 0) => format!(", line {line}"),
        _ => format!(", line {line}, column {column}"),
    }
}

/// A line of the text of a law on a line of its own, with a mark below the column. Of a long line, only the characters about the
/// column are shown.
fn excerpt(text: &str, column: usize) -> String {
    if text.is_empty() {
        return String::new();
    }
    let left_out = column.saturating_sub(WIDE / 2);
    let (before, rest) = (if left_out > 0 { "..." } else { "" }, text.chars().skip(left_out));
    let after = if rest.clone().count() > WIDE { "..." } else { "" };
    let shown: String = rest.take(WIDE).map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    let mark = match column {
        0 => String::new(),
        _ => format!("\n    {}^", " ".repeat(before.len() + column - left_out - 1)),
    };
    format!("\n    {before}{shown}{after}{mark}")
}

/// Returns the candidate that a mistyped word most likely means, or `None` if no candidate is near.
pub(crate) fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    if word.len() > SHOWN {
        return None;
    }
    let word = word.to_lowercase().replace('-', "_");
    let distances = candidates.iter().map(|candidate| (strsim::damerau_levenshtein(&word, candidate), *candidate));
    let (distance, candidate) = distances.min_by_key(|(distance, _)| *distance)?;
    (3 * distance <= candidate.chars().count()).then_some(candidate)
}

/// A remark on the candidate nearest to a word, from a list with commas; empty if none is near.
fn suggestion(word: &str, candidates: &str) -> String {
    let candidates: Vec<&str> = candidates.split(", ").collect();
    nearest(word, &candidates).map_or(String::new(), |near| format!(" (did you mean {near}?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_word_has_a_suggestion() {
        let names = crate::Settings::NAMES;
        let cases =
            [("gravty", "gravity"), ("Gravity", "gravity"), ("contact-froce", "contact_force"), ("frition", "friction")];
        for (word, expected) in cases {
            assert_eq!(nearest(word, names), Some(expected), "{word}");
        }
        for word in ["", "the", "table", "weight", &"gravity".repeat(20)] {
            assert_eq!(nearest(word, names), None, "{word}");
        }
    }

    #[test]
    fn quotes_are_short_and_escape_control_characters() {
        assert_eq!(quoted("1,5 \u{f6}"), "'1,5 \u{f6}'");
        assert_eq!(quoted("\u{1b}[2J\u{9b}\r"), "'\\u{1b}[2J\\u{9b}\\r'");
        assert_eq!(quoted(&"\u{fffd}".repeat(40)).chars().count(), 42);
        assert_eq!(quoted(&"x".repeat(1000)), format!("'{}...'", "x".repeat(40)));
        let message = |column| excerpt(&format!("{}y{}", "x".repeat(500), "z".repeat(500)), column);
        assert_eq!(message(0), format!("\n    {}...", "x".repeat(100)));
        assert_eq!(message(501), format!("\n    ...{}y{}...\n    {}^", "x".repeat(49), "z".repeat(50), " ".repeat(52)));
    }
}

/// The place in a step at which a body stopped being finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum BadStage {
    /// The collision phase (`apply_collisions`).
    Collisions = 0,
    /// The first force evaluation (the only one of symplectic Euler; with velocity Verlet, the one at the start of the step); 2, 3
    /// and 4 follow.
    Forces1 = 1,
    /// The second force evaluation of RK4, or the one at the end of a step of velocity Verlet.
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
