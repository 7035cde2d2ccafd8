//! Notes on what a file has that the scene does not have.

use std::collections::HashSet;

use crate::xml::Element;

/// Greatest number of notes. A file may have millions of unknown elements.
const MOST: usize = 1_000;

/// The notes of an import. Equal ones count once.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    all: Vec<String>,
    seen: HashSet<String>,
    more: usize,
}

impl Notes {
    /// Adds a note on an element.
    pub(crate) fn add(&mut self, element: &Element, text: impl AsRef<str>) {
        self.push(format!("{}: {}", element.place(), text.as_ref()));
    }

    /// Adds a note on an element that is not taken over. Elements of one name count once, with the first line.
    pub(crate) fn ignored(&mut self, element: &Element) {
        if self.seen.insert(format!("<{}> in {}", element.name, element.file.display())) {
            self.push(format!("{}: elements <{}> are not taken over", element.place(), element.name));
        }
    }

    /// Adds a note on an attribute that is not taken over. Equal attributes count once, with the first line.
    pub(crate) fn ignored_attribute(&mut self, element: &Element, key: &str) {
        if self.seen.insert(format!("<{} {key}> in {}", element.name, element.file.display())) {
            self.push(format!("{}: the attribute {key} is not taken over", element.place()));
        }
    }

    /// Adds a note on what stands for something in the scene. Equal ones count once, with the first place.
    pub(crate) fn replaced(&mut self, element: &Element, text: &str) {
        if self.seen.insert(text.to_owned()) {
            self.push(format!("{}: {text}", element.place()));
        }
    }

    pub(crate) fn push(&mut self, note: String) {
        if self.all.len() >= MOST {
            self.more += 1;
        } else if self.seen.insert(note.clone()) {
            self.all.push(note);
        }
    }

    pub(crate) fn into_vec(mut self) -> Vec<String> {
        if self.more > 0 {
            self.all.push(format!("{} more notes were left out", self.more));
        }
        self.all
    }
}
