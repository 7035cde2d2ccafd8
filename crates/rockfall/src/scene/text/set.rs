//! The line `set NAME VALUE`.

use super::comment::is_number;
use super::line::{Line, Wrong};
use super::{LineWarning, Reader};
use crate::error::{Error, Result, nearest, quoted};
use crate::settings::{ContactLaw, Settings};

/// A value for a message, or a word in place of one that is missing or long.
fn shown(value: &str) -> &str {
    if is_number(value) && value.len() < 20 { value } else { "VALUE" }
}

/// The key of the line `@run` that a word after `set` means.
fn key_for(word: &str) -> Option<&'static str> {
    match word.to_ascii_lowercase().replace('-', "_").as_str() {
        "dt" | "timestep" | "time_step" => Some("`@run dt=SECONDS`"),
        "steps" => Some("`@run steps=N`"),
        "time" | "duration" => Some("`@run dt=SECONDS steps=N`"),
        "integrator" => Some("`@run integrator=NAME`"),
        "substeps" => Some("`@run substeps=N`"),
        _ => None,
    }
}

impl Reader<'_> {
    pub(super) fn set(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(word) = words.next() else {
            let message = "a setting without a name, expected `set NAME VALUE`".to_owned();
            return self.not_understood(number, Wrong { field: "set".to_owned(), message });
        };
        if let Some((name, value)) = word.split_once('=').filter(|(name, _)| Settings::NAMES.contains(name)) {
            let message = format!("expected a space in place of `=`: `set {name} {}`", shown(value));
            return Err(Wrong { field: format!("set {}", quoted(word)), message });
        }
        let Some(name) = Settings::NAMES.iter().copied().find(|name| *name == word) else {
            if let Some(key) = key_for(word) {
                let message = format!("not a constant, expected {key}");
                return self.not_understood(number, Wrong { field: format!("set {}", quoted(word)), message });
            }
            let known = format!("expected one of {}", Settings::NAMES.join(", "));
            let message = nearest(word, Settings::NAMES).map_or(known, |near| format!("did you mean {near}?"));
            let message = format!("an unknown setting, {message}");
            return self.not_understood(number, Wrong { field: format!("set {}", quoted(word)), message });
        };
        if let Some(before) = self.set_at.insert(name, number) {
            let text = format!("{name} is set again; this replaces line {before}");
            self.warnings.push(LineWarning { line: number, text });
        }
        let value = words.collect::<Vec<_>>().join(" ");
        let wrong = |error| Wrong {
            field: format!("set {name}"),
            message: match error {
                Error::Invalid { expected, .. } if value.is_empty() => format!("no value, expected {expected}"),
                Error::Invalid { value: given, .. } if value.starts_with('=') => {
                    let rest = value.trim_start_matches('=').trim();
                    format!("{given} is not allowed, expected no `=`: `set {name} {}`", shown(rest))
                }
                Error::Invalid { value, expected, .. } => format!("{value} is not allowed, expected {expected}"),
                other => other.to_string(),
            },
        };
        if name == "contact_law" {
            self.set_law(&value).map_err(wrong)
        } else {
            self.scene.settings.set(name, &value).map_err(wrong)
        }
    }

    /// Sets the contact law, and what follows from it unless the text sets that: the order of the lines does not matter.
    fn set_law(&mut self, law: &str) -> Result<()> {
        let before = self.scene.settings;
        self.scene.settings.set("contact_law", law)?;
        for given in Settings::FOLLOW_LAW.into_iter().filter(|name| self.set_at.contains_key(name)) {
            self.scene.settings.set(given, &before.get(given).unwrap_or_default())?;
        }
        Ok(())
    }

    /// Sets the law `rigid` where the text leaves the choice and the objects need this law, if a line gives a number that `auto` would
    /// take for the default of another law.
    pub(super) fn choose_law(&mut self) {
        let (now, plain) = (self.scene.settings, Settings::default());
        let is_plain = |name: &str| self.set_at.contains_key(name) && now.get(name) == plain.get(name);
        let is_mistaken = is_plain("restitution") || is_plain("coulomb_friction");
        if now.contact_law == ContactLaw::Auto && self.scene.is_rigid() && is_mistaken {
            // Both values were read before.
            let _ = self.set_law(ContactLaw::Rigid.name());
        }
    }
}
