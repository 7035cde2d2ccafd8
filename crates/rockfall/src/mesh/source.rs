//! What the readers of all formats have in common.

use std::str::{Split, SplitAsciiWhitespace};

use crate::error::{MeshPlace, quoted};

/// Vertices and triangles as a file lists them.
#[derive(Default)]
pub(super) struct Soup {
    pub(super) vertices: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Divides a polygon into triangles that share its first vertex.
#[derive(Default)]
pub(super) struct Fan {
    first: u32,
    last: u32,
    /// Number of vertices so far.
    pub(super) found: usize,
}

impl Fan {
    /// Adds the next vertex, and the triangle that ends with it.
    pub(super) fn add(&mut self, index: u32, triangles: &mut Vec<[u32; 3]>) {
        match self.found {
            0 => self.first = index,
            1 => (),
            _ => triangles.push([self.first, self.last, index]),
        }
        self.last = index;
        self.found += 1;
    }
}

/// What is wrong with a file.
pub(super) struct Wrong {
    pub(super) place: MeshPlace,
    pub(super) message: String,
}

/// The result of a reader.
pub(super) type Read<T> = Result<T, Wrong>;

/// An error about a line of a text.
pub(super) fn wrong_line(line: usize, message: impl Into<String>) -> Wrong {
    Wrong { place: MeshPlace::Line(line), message: message.into() }
}

/// An error about a byte.
pub(super) fn wrong_byte(offset: usize, message: impl Into<String>) -> Wrong {
    Wrong { place: MeshPlace::Byte(offset), message: message.into() }
}

/// Names of coordinates in messages.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads a coordinate from a word of a text.
pub(super) fn coordinate(word: &str, axis: &str, line: usize) -> Read<f32> {
    let kind = match word.parse::<f32>() {
        Ok(number) if number.is_finite() => return Ok(number),
        Ok(_) => "not finite (in f32)",
        Err(_) => "not a number",
    };
    Err(wrong_line(line, format!("{axis} of a vertex: {} is {kind}, expected a finite number", quoted(word))))
}

/// The lines of a text, without their ends. They end with LF or CRLF, or with CR if there is no LF.
pub(super) fn lines(text: &str) -> Split<'_, char> {
    text.split(if text.contains('\n') { '\n' } else { '\r' })
}

/// Removes a byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The words of a text, with the numbers of their lines.
pub(super) struct Words<'a> {
    lines: Split<'a, char>,
    words: SplitAsciiWhitespace<'a>,
    /// Number of lines that were begun.
    begun: usize,
    /// Line of the last word, from 1.
    pub(super) line: usize,
}

impl<'a> Words<'a> {
    /// The words of a text after so many other lines.
    pub(super) fn new(text: &'a str, before: usize) -> Self {
        Self { lines: lines(text), words: "".split_ascii_whitespace(), begun: before, line: before.max(1) }
    }

    /// The next word. `None` at the end of the text.
    pub(super) fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.words.next() {
                self.line = self.begun;
                return Some(word);
            }
            self.words = self.lines.next()?.split_ascii_whitespace();
            self.begun += 1;
        }
    }

    /// Leaves out the words up to the end of the line.
    pub(super) fn skip_line(&mut self) {
        self.words = "".split_ascii_whitespace();
    }

    /// The next word, which must not be missing.
    pub(super) fn expect(&mut self, what: &str) -> Read<&'a str> {
        self.next().ok_or_else(|| self.wrong(format!("the file ends early, expected {what}")))
    }

    /// An error about the line of the last word.
    pub(super) fn wrong(&self, message: impl Into<String>) -> Wrong {
        wrong_line(self.line, message)
    }
}
