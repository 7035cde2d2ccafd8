//! What holds for every error.

use rockfall::Error;

/// Upper bound of the length of an error message, in bytes. Messages quote words of the input. Those about laws also show a line.
pub(crate) const LONGEST_MESSAGE: usize = 600;

/// Checks that a message is short and has no control characters. The error of a law shows a line of its text on lines of their own.
///
/// # Panics
/// When it is not.
pub(crate) fn assert_short(error: &Error) {
    let message = error.to_string();
    let is_law = matches!(error, Error::Law { .. });
    let most = if is_law { 3 * LONGEST_MESSAGE } else { LONGEST_MESSAGE };
    assert!(message.len() < most, "{} bytes: {message}", message.len());
    assert!(!message.contains(|letter: char| letter.is_control() && !(is_law && letter == '\n')), "{message:?}");
}
