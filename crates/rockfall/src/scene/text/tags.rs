//! Lines that say how objects are called and drawn: `@name`, `@colour`, `@look` and `@label`.

use super::Reader;
use super::line::{COLOUR, Kind, LABEL, LOOK, Line, NAME, Wrong};
use crate::error::{Result, quoted};
use crate::scene::{ObjectId, Tag, shared};

impl Reader<'_> {
    pub(super) fn name(&mut self, line: &str, number: usize) -> Line<()> {
        match only_word(&NAME, line) {
            Ok(word) => self.tag(&NAME, "NAME", word, |tag, name| {
                tag.name = name.map(str::to_owned);
                Ok(())
            }),
            Err(wrong) => self.not_understood(number, wrong),
        }
    }

    pub(super) fn colour(&mut self, line: &str, number: usize) -> Line<()> {
        match only_word(&COLOUR, line) {
            Ok(word) => self.tag(&COLOUR, "COLOUR", word, |tag, colour| {
                tag.colour = colour.map(str::parse).transpose()?;
                Ok(())
            }),
            Err(wrong) => self.not_understood(number, wrong),
        }
    }

    pub(super) fn look(&mut self, line: &str, number: usize) -> Line<()> {
        match only_word(&LOOK, line) {
            Ok(word) => self.tag(&LOOK, "LOOK", word, |tag, look| {
                tag.look = look.map(str::parse).transpose()?;
                Ok(())
            }),
            Err(wrong) => self.not_understood(number, wrong),
        }
    }

    pub(super) fn label(&mut self, line: &str, number: usize) -> Line<()> {
        let text = line.trim_start().strip_prefix(LABEL.word).unwrap_or_default().trim();
        if text.is_empty() {
            return self.not_understood(number, missing(&LABEL));
        }
        self.tag(&LABEL, "TEXT", text, |tag, label| {
            // Where no label is in use, `-` says that the scene has none.
            let has_none = tag.label.as_deref().is_none_or(str::is_empty);
            tag.label = label.or(has_none.then_some("")).map(str::to_owned);
            Ok(())
        })
    }

    /// Changes the tag of the following objects. The value is `None` for `-`.
    fn tag(
        &mut self,
        kind: &Kind,
        field: &str,
        value: &str,
        change: impl FnOnce(&mut Tag, Option<&str>) -> Result<()>,
    ) -> Line<()> {
        let mut tag = self.tag.as_deref().cloned().unwrap_or_default();
        let changed = change(&mut tag, Some(value).filter(|value| *value != "-")).and_then(|()| tag.validate());
        changed.map_err(|error| Wrong { field: format!("{} {field}", kind.word), message: kind.refused(&error).message })?;
        self.tag = shared(tag);
        Ok(())
    }

    /// Gives an object the tag in use.
    pub(super) fn tag_object(&mut self, kind: &Kind, id: impl Into<ObjectId>) -> Line<()> {
        self.scene.share_tag(id.into(), &self.tag).map_err(|error| kind.refused(&error))
    }
}

fn missing(kind: &Kind) -> Wrong {
    let [word, form] = [kind.word.to_owned(), kind.form()];
    let field = form.trim_start_matches(kind.word).trim();
    kind.wrong(field, format!("missing, expected `{form}`, or `{word} -` for none"))
}

/// The only word after the first one.
pub(super) fn only_word<'a>(kind: &Kind, line: &'a str) -> Line<&'a str> {
    let mut words = line.split_ascii_whitespace().skip(1);
    let word = words.next().ok_or_else(|| missing(kind))?;
    match words.next() {
        None => Ok(word),
        Some(more) => {
            let message = format!("one word too many, expected `{}`, or `{} -` for none", kind.form(), kind.word);
            Err(kind.wrong(&quoted(more), message))
        }
    }
}

#[cfg(test)]
#[path = "tags_tests.rs"]
mod tests;
