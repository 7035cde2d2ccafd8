//! Comments of a scene text, and comments that look like something else.

use super::line::{BOX, CAPSULE, COLOUR, FORCE, GROUP, Kind, MUSCLE, ORIENTATION, POLYGON, ROD, SPHERE, SPRING, TETHER};
use crate::error::{nearest, quoted};
use crate::scene::is_hexadecimal;
use crate::settings::Settings;

/// Number of words of a comment that are looked at.
const WORDS: usize = 32;

/// Kinds of lines with the words by which people call them, in lower case.
const NAMES: [(&Kind, &[&str]); 11] = [
    (&SPHERE, &["s", "sphere", "spheres", "ball"]),
    (&ROD, &["r", "rod", "rods"]),
    (&CAPSULE, &["c", "capsule", "capsules"]),
    (&POLYGON, &["p", "polygon", "polygons", "plane", "triangle"]),
    (&SPRING, &["k", "spring", "springs"]),
    (&BOX, &["b", "box", "boxes", "cuboid", "cube"]),
    (&TETHER, &["t", "tether", "tethers"]),
    (&GROUP, &["group", "groups"]),
    (&ORIENTATION, &["orientation"]),
    (&FORCE, &["force"]),
    (&MUSCLE, &["muscle", "muscles"]),
];

/// The comment at the beginning of a text.
#[derive(Default)]
pub(super) struct Title {
    pub(super) lines: Vec<String>,
    is_complete: bool,
}

impl Title {
    /// Adds the next line of the text.
    pub(super) fn add(&mut self, line: &str, is_comment: bool) {
        let is_blank = line.trim().is_empty();
        self.is_complete |= !(is_comment || is_blank && self.lines.is_empty());
        if is_comment && !self.is_complete {
            let text = line.trim_end();
            let text = text.trim_start().strip_prefix('#').unwrap_or(text);
            self.lines.push(text.strip_prefix(' ').unwrap_or(text).to_owned());
        }
    }
}

/// Removes a comment from a line: from a `#` at its beginning or after white space. The `#` of a colour begins none.
pub(super) fn without_comment(line: &str) -> &str {
    let begins = |(at, _): &(usize, &str)| line[..*at].chars().next_back().is_none_or(char::is_whitespace);
    let is_colour = |at: usize| {
        let word = line[at..].split_ascii_whitespace().next().unwrap_or_default();
        is_hexadecimal(word) && line[..at].trim() == COLOUR.word
    };
    let found = line.match_indices('#').filter(|(at, _)| !is_colour(*at)).find(begins);
    found.map_or(line, |(at, _)| &line[..at])
}

/// Whether a line has a comment that begins with `#`, which the thesis's format lacks.
pub(super) fn has_number_sign(line: &str) -> bool {
    without_comment(line).len() < line.len()
}

/// Whether the line of an object is prose that only begins with the letter of one, such as `K is the spring`: less than half of
/// its words after the first one are numbers.
pub(super) fn may_be_prose(line: &str) -> bool {
    let mut words = without_comment(line).split_ascii_whitespace().take(WORDS);
    let is_letter = words.next().is_some_and(|word| word.len() == 1);
    let (mut numbers, mut others) = (0, 0);
    for word in words {
        let count = if is_number(word) { &mut numbers } else { &mut others };
        *count += 1;
    }
    is_letter && others > numbers
}

/// Whether a line begins like an extension of the thesis's format.
pub(super) fn is_extension(line: &str) -> bool {
    let mut words = without_comment(line).split_ascii_whitespace();
    match words.next() {
        Some("set") => true,
        Some("T") => words.next().is_some_and(is_number),
        Some(word) => word.starts_with('@'),
        None => false,
    }
}

/// Whether a word is a number. The names of infinity and NaN are words.
pub(super) fn is_number(word: &str) -> bool {
    let digits = word.trim_start_matches(['+', '-', '.']);
    digits.starts_with(|first: char| first.is_ascii_digit()) && word.parse::<f64>().is_ok()
}

fn is_value(word: &str) -> bool {
    let word = word.trim_end_matches([',', ';', '.']);
    is_number(word) || ["on", "off", "true", "false"].contains(&word)
}

/// The constant that a word names in any spelling: `Gravity`, `contact-force:`.
fn setting(word: &str) -> Option<&'static str> {
    let name = word.trim_end_matches(['=', ':']).to_ascii_lowercase().replace('-', "_");
    Settings::NAMES.iter().copied().find(|known| *known == name)
}

/// Describes what a comment looks like and how that is written, or returns `None` for prose.
pub(super) fn looks_like(line: &str) -> Option<String> {
    let words: Vec<&str> = line.split_ascii_whitespace().take(WORDS).collect();
    let (first, rest) = words.split_first()?;
    if !is_number(first) && !first.starts_with(char::is_alphanumeric) {
        return None;
    }
    if let Some(name) = setting_of(first, rest) {
        return Some(format!("it looks like a setting, which is `set {name} VALUE`"));
    }
    let word = first.trim_end_matches([':', ',']).to_ascii_lowercase();
    let is_mesh = |name: &&&str| [".stl", ".obj", ".ply"].iter().any(|end| name.to_ascii_lowercase().ends_with(end));
    if word == "mesh" && rest.iter().any(|name| is_mesh(&name)) {
        return Some("it looks like a mesh, which a scene cannot contain".to_owned());
    }
    let numbers = rest.iter().filter(|word| is_number(word)).count();
    let mostly_numbers = numbers > 0 && 2 * numbers >= rest.len();
    let assigns = rest.iter().any(|word| word.split_once('=').is_some_and(|(_, value)| is_number(value)));
    let kind = NAMES.iter().find(|(_, names)| names.contains(&word.as_str()));
    if let Some((kind, _)) = kind {
        let fits = if word.len() == 1 { rest.first().is_some_and(|word| is_number(word)) } else { true };
        return (fits && (mostly_numbers || assigns)).then(|| format!("it looks like a line `{}`", kind.form()));
    }
    (numbers >= 3 && numbers == rest.len()).then(|| {
        let known = NAMES.map(|(kind, _)| kind.word);
        format!("it looks like an object, but {} is not one of {}", quoted(first), known.join(", "))
    })
}

/// The constant that a comment seems to set: `gravity 3`, `Gravity = 3`, `gravity=3`, `SET gravity 3`, `Set gravty 3`.
fn setting_of(first: &str, rest: &[&str]) -> Option<&'static str> {
    if let Some((name, value)) = first.split_once('=').filter(|(_, value)| is_value(value)) {
        return setting(name).filter(|_| is_value(value));
    }
    let value = |words: &[&str]| match words {
        ["=" | ":", value, ..] | [value, ..] => is_value(value.trim_start_matches('=')),
        [] => false,
    };
    if let Some(name) = setting(first) {
        return value(rest).then_some(name);
    }
    let (second, after) = rest.split_first()?;
    let near = if first.eq_ignore_ascii_case("set") { nearest(second, Settings::NAMES) } else { None };
    setting(second).or(near).filter(|_| value(after))
}
