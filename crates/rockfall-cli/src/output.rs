//! Standard output and standard error, either of which may be closed at any time.

use std::borrow::Cow;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, INTERRUPTED};

/// Whether nothing is printed, because another process prints the same.
static IS_SILENT: AtomicBool = AtomicBool::new(false);

/// Switches all output of this process off or on.
#[cfg(feature = "mpi")]
pub(crate) fn silence(is_silent: bool) {
    IS_SILENT.store(is_silent, Ordering::Relaxed);
}

/// Whether nothing is printed.
pub(crate) fn is_silent() -> bool {
    IS_SILENT.load(Ordering::Relaxed)
}

/// Prints the result of a command.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    if is_silent() {
        return Ok(());
    }
    let mut out = BufWriter::new(io::stdout().lock());
    match out.write_all(harmless(text).as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Failure::ClosedPipe),
        Err(error) => Err(Failure::Run(format!("standard output cannot be written: {error}"))),
    }
}

/// Prints a line on standard error. If standard error is closed, the line is dropped.
pub(crate) fn note(line: &str) {
    if !is_silent() {
        let _ = writeln!(io::stderr(), "{}", harmless(line));
    }
}

/// A text with control characters escaped, which a terminal would obey, and with those that turn the direction of writing. Names of
/// files and of objects may hold them.
fn harmless(text: &str) -> Cow<'_, str> {
    let turns = |letter: char| matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_obeyed = |letter: char| turns(letter) || letter.is_control() && !matches!(letter, '\n' | '\t');
    if !text.contains(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let escaped = |letter| if is_obeyed(letter) { letter.escape_default().to_string() } else { letter.to_string() };
    text.chars().map(escaped).collect()
}

/// A name that a file brings along, on one line, so that it cannot look like a line of this program.
pub(crate) fn on_one_line(name: &str) -> String {
    name.replace('\n', "\\n")
}

/// Prints the message of a failure, if it has one, and returns its exit code.
pub(crate) fn report(failure: Failure) -> ExitCode {
    let (code, message) = match failure {
        Failure::ClosedPipe => return ExitCode::SUCCESS,
        #[cfg(feature = "mpi")]
        Failure::Elsewhere => return ExitCode::SUCCESS,
        Failure::Interrupted(message) => {
            note(&message);
            return ExitCode::from(INTERRUPTED);
        }
        Failure::Usage(message) => (2, message),
        Failure::Run(message) => (1, message),
    };
    note(&format!("error: {message}"));
    ExitCode::from(code)
}

/// Why there are no tensions.
pub(crate) const NO_LINKS: &str = "the scene has no springs, muscles and tethers; the model keeps the lengths of rods without a force, so rods have no tension";
