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
    /// Time that a message is shown, in s. All messages stay in the list of the menu.
    fn seconds(self) -> f64 {
        match self {
            Self::Note => 5.0,
            Self::Warning => 10.0,
            Self::Error => 20.0,
        }
    }

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
    /// Time at which it was first shown, in s since the window opened. Opening a window may take longer than a message is
    /// shown, so messages count from here.
    since: Option<f64>,
}

impl Message {
    /// Whether it is shown at the time `now`.
    fn is_shown(&self, now: f64) -> bool {
        !self.dismissed && self.since.is_none_or(|since| now - since < self.level.seconds())
    }
}

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
        self.all.push(Message { level, text, at: now, dismissed: false, since: None });
        let surplus = self.all.len().saturating_sub(KEPT);
        self.all.drain(..surplus);
    }

    /// Removes the warnings with these texts, because they no longer hold.
    pub(super) fn withdraw(&mut self, texts: &[String]) {
        self.all.retain(|message| message.level != Level::Warning || !texts.contains(&message.text));
    }

    /// Returns all messages, the oldest first.
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    /// Returns the messages that are shown at the time `now`, with their indices.
    pub fn shown(&mut self, now: f64) -> impl DoubleEndedIterator<Item = (usize, &Message)> {
        for message in &mut self.all {
            message.since.get_or_insert(now);
        }
        self.all.iter().enumerate().filter(move |(_, message)| message.is_shown(now))
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

    fn shown(messages: &mut Messages, now: f64) -> Vec<String> {
        messages.shown(now).map(|(_, message)| message.text.clone()).collect()
    }

    #[test]
    fn messages_disappear_and_errors_last() {
        let mut messages = Messages::default();
        messages.add(Level::Note, "saved", 0.0);
        messages.add(Level::Error, "no such file", 1.0);
        assert_eq!(shown(&mut messages, 2.0), ["saved", "no such file"]);
        assert_eq!(shown(&mut messages, 8.0), ["no such file"]);
        assert!(shown(&mut messages, 30.0).is_empty());
        assert_eq!(messages.all().len(), 2);
        messages.add(Level::Error, "a disk is full", 31.0);
        assert_eq!(shown(&mut messages, 31.0), ["a disk is full"]);
        messages.dismiss(2);
        assert!(shown(&mut messages, 31.0).is_empty());
    }

    /// Opening a window may take a minute.
    #[test]
    fn a_message_is_shown_from_the_first_frame_on() {
        let mut messages = Messages::default();
        messages.add(Level::Warning, "a typing error", 0.0);
        assert_eq!(shown(&mut messages, 60.0), ["a typing error"]);
        assert_eq!(shown(&mut messages, 69.0), ["a typing error"]);
        assert!(shown(&mut messages, 71.0).is_empty());
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
