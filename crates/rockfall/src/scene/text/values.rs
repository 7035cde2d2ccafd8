//! The words KEY=VALUE of a line.

use std::str::FromStr;

use glam::DVec3;

use super::line::{Kind, Line};
use super::motion::{number, vector};
use crate::error::{nearest, quoted};

/// Keys of which a line has at most one.
const ALTERNATIVES: [&[&str]; 3] = [&["rate", "mass_rate", "volume_rate"], &["mass", "density"], &["force", "torque"]];

/// The values of a line by their keys.
pub(super) struct Values<'a> {
    pub(super) kind: &'a Kind,
    values: Vec<(&'a str, &'a str)>,
}

impl<'a> Values<'a> {
    pub(super) fn read(kind: &'a Kind, keys: &[&str], words: impl Iterator<Item = &'a str>) -> Line<Self> {
        let mut found = Self { kind, values: Vec::new() };
        for word in words {
            let Some((key, value)) = word.split_once('=') else {
                return Err(kind.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", keys.join(", "))));
            };
            if !keys.contains(&key) {
                let known = || format!("expected one of {}", keys.join(", "));
                let hint = nearest(key, keys).map_or_else(known, |near| format!("did you mean {near}?"));
                return Err(kind.wrong(&quoted(key), format!("an unknown key, {hint}")));
            }
            if found.of(key).is_some() {
                return Err(kind.wrong(key, "given twice in the line"));
            }
            let others = ALTERNATIVES.into_iter().filter(|keys| keys.contains(&key)).flatten();
            if let Some(other) = others.copied().find(|other| found.of(other).is_some()) {
                return Err(kind.wrong(key, format!("given together with {other}, expected one of the two")));
            }
            found.values.push((key, value));
        }
        Ok(found)
    }

    pub(super) fn of(&self, key: &str) -> Option<&'a str> {
        self.values.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    pub(super) fn number(&self, key: &str) -> Line<Option<f64>> {
        self.of(key).map(|value| number(self.kind, key, value)).transpose()
    }

    pub(super) fn parsed<T: FromStr>(&self, key: &str, expected: &str) -> Line<Option<T>> {
        let wrong = |value: &str| self.kind.wrong(key, format!("{} is not allowed, expected {expected}", quoted(value)));
        self.of(key).map(|value| value.parse().map_err(|_| wrong(value))).transpose()
    }

    /// Three numbers with commas between them.
    pub(super) fn vector(&self, key: &str) -> Line<Option<DVec3>> {
        self.of(key).map(|value| vector(self.kind, key, value)).transpose()
    }

    /// The error of a value that has to be there.
    pub(super) fn needed<T>(&self, key: &str, value: Option<T>) -> Line<T> {
        value.ok_or_else(|| self.kind.wrong(key, format!("missing, expected {}", self.kind.form())))
    }
}
