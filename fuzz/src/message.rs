//! What holds for every error.

use rockfall::Error;

/// Upper bound of the length of an error message, in bytes. Messages quote words of the input.
pub(crate) const LONGEST_MESSAGE: usize = 600;

/// Checks that a message is short and has no control characters. The error of a law shows a line of its text on lines of their own.
///
/// # Panics
/// When it is not.
pub(crate) fn assert_short(error: &Error) {
    let message = error.to_string();
    assert!(message.len() < LONGEST_MESSAGE, "{} bytes: {message}", message.len());
    let is_law = matches!(error, Error::Law { .. });
    assert!(!message.contains(|letter: char| letter.is_control() && !(is_law && letter == '\n')), "{message:?}");
}
