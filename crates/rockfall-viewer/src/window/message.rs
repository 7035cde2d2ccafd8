//! Messages to the user.

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Information about what was done.
    Note,
    /// A possible mistake.
    Warning,
    /// An action that failed.
    Error,
}

impl Level {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Severity.
    pub level: Level,
    /// Text.
    pub text: String,
    /// Time of the message, in s since the window opened.
    pub at: f64,
    /// Whether the user dismissed it.
    pub dismissed: bool,
}

/// Time that notes and warnings are shown, in s. Errors stay until they are dismissed.
const SHOWN: f64 = 6.0;
/// Number of messages that are kept.
const KEPT: usize = 100;

/// The last messages of a session.
#[derive(Clone, Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
}

impl Messages {
    /// Adds a message. An older message with the same level and text is removed.
    pub fn add(&mut self, level: Level, text: impl Into<String>, now: f64) {
        let text = text.into();
        self.all.retain(|message| message.text != text || message.level != level);
        self.all.push(Message { level, text, at: now, dismissed: false });
        let surplus = self.all.len().saturating_sub(KEPT);
        self.all.drain(..surplus);
    }

    /// Returns all messages, the oldest first.
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    /// Returns the messages that are shown at the time `now`, with their indices.
    pub fn shown(&self, now: f64) -> impl DoubleEndedIterator<Item = (usize, &Message)> {
        let is_shown =
            move |message: &Message| !message.dismissed && (message.level == Level::Error || now - message.at < SHOWN);
        self.all.iter().enumerate().filter(move |(_, message)| is_shown(message))
    }

    /// Dismisses a message.
    pub fn dismiss(&mut self, index: usize) {
        if let Some(message) = self.all.get_mut(index) {
            message.dismissed = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_until_they_are_dismissed_and_notes_disappear() {
        let mut messages = Messages::default();
        messages.add(Level::Note, "saved", 0.0);
        messages.add(Level::Error, "no such file", 1.0);
        let shown = |messages: &Messages, now| messages.shown(now).map(|(_, message)| message.text.clone()).collect::<Vec<_>>();
        assert_eq!(shown(&messages, 2.0), ["saved", "no such file"]);
        assert_eq!(shown(&messages, 1000.0), ["no such file"]);
        messages.dismiss(1);
        assert!(shown(&messages, 1000.0).is_empty());
        assert_eq!(messages.all().len(), 2);
    }

    #[test]
    fn a_repeated_message_is_kept_once_and_last() {
        let mut messages = Messages::default();
        for (now, text) in ["a", "b", "a"].into_iter().enumerate() {
            messages.add(Level::Error, text, now as f64);
        }
        let texts: Vec<&str> = messages.all().iter().map(|message| message.text.as_str()).collect();
        assert_eq!(texts, ["b", "a"]);
        for number in 0..1000 {
            messages.add(Level::Note, number.to_string(), 3.0);
        }
        assert_eq!(messages.all().len(), KEPT);
    }
}
