//! Names as scene texts have them.

use std::collections::HashSet;

use crate::notes::Notes;
use crate::xml::{Element, quoted};

/// Longest name, in characters.
const LONGEST: usize = 100;

/// Names that differ.
#[derive(Debug)]
pub(super) struct Names(HashSet<String>);

impl Names {
    /// No names but some that nothing may have.
    pub(super) fn new(taken: &[&str]) -> Self {
        Self(taken.iter().map(|name| (*name).to_owned()).collect())
    }

    /// A name of one word that nothing else has.
    pub(super) fn word(&mut self, wanted: &str, element: &Element, notes: &mut Notes) -> String {
        let is_allowed = |letter: char| !letter.is_whitespace() && !letter.is_control() && !"=,#".contains(letter);
        let mut word: String =
            wanted.chars().take(LONGEST).map(|letter| if is_allowed(letter) { letter } else { '_' }).collect();
        if !word.starts_with(|first: char| first.is_alphabetic() || first == '_') {
            word.insert(0, '_');
        }
        let mut number = 2;
        let mut name = word.clone();
        while !self.0.insert(name.clone()) {
            name = format!("{word}_{number}");
            number += 1;
        }
        if name != wanted {
            notes.add(element, format!("the name {} is {name} in the scene", quoted(wanted)));
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn names_are_words_that_differ() {
        let (mut names, mut notes) = (Names::new(&["world"]), Notes::default());
        let element = Element::empty("link", Path::new("a.urdf"));
        let found = ["arm", "arm", "2 left=a#b", "", "world"].map(|name| names.word(name, &element, &mut notes));
        assert_eq!(found, ["arm", "arm_2", "_2_left_a_b", "_", "world_2"]);
        assert_eq!(notes.into_vec().len(), 4);
    }
}
