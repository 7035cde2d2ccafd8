//! XML files as trees of elements that know their place, with limits for files of strangers.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rockfall::glam::DVec3;

use crate::error::{Error, Result};

/// Size of the largest file that is read, in bytes.
const LARGEST_FILE: u64 = 64 << 20;
/// Greatest number of elements, with those of included files.
const MOST_ELEMENTS: usize = 500_000;
/// Greatest depth of elements.
const DEEPEST: usize = 200;
/// Greatest number of attributes of an element.
const MOST_ATTRIBUTES: usize = 200;
/// Greatest number of files.
const MOST_FILES: usize = 500;
/// Longest value that a message quotes, in characters.
const QUOTED: usize = 60;

/// An element with its attributes and children.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) file: Arc<Path>,
    /// Line number, from 1.
    pub(crate) line: usize,
    attributes: Vec<(String, String)>,
    pub(crate) children: Vec<Self>,
}

/// Reads files. Limits hold for all of them together.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    elements: usize,
    files: usize,
}

impl Reader {
    /// Reads the root element of a file.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Element> {
        self.read_at(path, 0)
    }

    /// Reads a file whose root element comes to lie at a depth.
    pub(crate) fn read_at(&mut self, path: &Path, depth: usize) -> Result<Element> {
        let text = text_of(path)?;
        self.parse(path, &text, depth)
    }

    pub(crate) fn parse(&mut self, path: &Path, text: &str, depth: usize) -> Result<Element> {
        let whole = |line, message: String| {
            Err(Error::Element { file: path.to_owned(), line, element: "the file".to_owned(), message })
        };
        self.files += 1;
        if self.files > MOST_FILES {
            return whole(1, format!("more than {MOST_FILES} files"));
        }
        let options = roxmltree::ParsingOptions { nodes_limit: 4 * MOST_ELEMENTS as u32, ..Default::default() };
        let document = match roxmltree::Document::parse_with_options(text, options) {
            Ok(document) => document,
            Err(error) => {
                let told = without_controls(&error.to_string());
                return whole(error.pos().row as usize, format!("{told}, expected XML without a document type"));
            }
        };
        let lines = Lines::of(text);
        self.convert(document.root_element(), &Arc::from(path), &lines, depth)
    }

    fn convert(&mut self, node: roxmltree::Node<'_, '_>, file: &Arc<Path>, lines: &Lines, depth: usize) -> Result<Element> {
        let name = node.tag_name().name().to_owned();
        let attributes = node.attributes().map(|a| (a.name().to_owned(), a.value().to_owned())).collect();
        let line = lines.at(node.range().start);
        let mut element = Element { name, file: file.clone(), line, attributes, children: Vec::new() };
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(element.wrong(format!("more than {MOST_ELEMENTS} elements")));
        }
        if element.attributes.len() > MOST_ATTRIBUTES {
            return Err(element.wrong(format!("more than {MOST_ATTRIBUTES} attributes")));
        }
        if depth > DEEPEST {
            return Err(element.wrong(format!("elements are nested deeper than {DEEPEST}")));
        }
        for child in node.children().filter(roxmltree::Node::is_element) {
            element.children.push(self.convert(child, file, lines, depth + 1)?);
        }
        Ok(element)
    }
}

/// Where lines begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect())
    }

    fn at(&self, offset: usize) -> usize {
        self.0.partition_point(|end| *end < offset) + 1
    }
}

fn text_of(path: &Path) -> Result<String> {
    let failed = |source| Error::File { file: path.to_owned(), source };
    let refused = |message: &str| failed(std::io::Error::other(message.to_owned()));
    // Before it is opened, because opening a pipe waits for its other end.
    let found = std::fs::metadata(path).map_err(failed)?;
    if !found.is_file() {
        return Err(refused("a folder, a device or a pipe, expected a regular file"));
    }
    if found.len() > LARGEST_FILE {
        return Err(refused("more than 64 MiB, expected a file of at most 64 MiB"));
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(LARGEST_FILE).read_to_end(&mut bytes)).map_err(failed)?;
    String::from_utf8(bytes).map_err(|_| refused("bytes that are no UTF-8, expected text"))
}

impl Element {
    /// An element that stands for a missing one.
    pub(crate) fn empty(name: &str, file: &Path) -> Self {
        Self { name: name.to_owned(), file: Arc::from(file), line: 1, attributes: Vec::new(), children: Vec::new() }
    }

    /// The element without its children.
    pub(crate) fn alone(&self) -> Self {
        let (name, file, attributes) = (self.name.clone(), self.file.clone(), self.attributes.clone());
        Self { name, file, line: self.line, attributes, children: Vec::new() }
    }

    /// Adds the attributes of another element. They replace those of the same name.
    pub(crate) fn overlay(&mut self, other: &Self) {
        for (key, value) in &other.attributes {
            match self.attributes.iter_mut().find(|(known, _)| known == key) {
                Some((_, old)) => old.clone_from(value),
                None => self.attributes.push((key.clone(), value.clone())),
            }
        }
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    pub(crate) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    pub(crate) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The element as messages show it.
    pub(crate) fn title(&self) -> String {
        let named = ["name", "class", "joint", "link", "file", "filename"];
        match named.into_iter().find_map(|key| Some((key, self.attribute(key)?))) {
            Some((key, value)) => format!("<{} {key}={}>", shortened(&self.name), quoted(value)),
            None => format!("<{}>", shortened(&self.name)),
        }
    }

    /// File, line and element, as notes begin.
    pub(crate) fn place(&self) -> String {
        format!("{}:{}: {}", self.file.display(), self.line, self.title())
    }

    pub(crate) fn wrong(&self, message: impl Into<String>) -> Error {
        Error::Element { file: self.file.to_path_buf(), line: self.line, element: self.title(), message: message.into() }
    }

    /// The child with a name that must be there.
    pub(crate) fn needed_child(&self, name: &str) -> Result<&Self> {
        self.child(name).ok_or_else(|| self.wrong(format!("no element <{name}>, expected one")))
    }

    pub(crate) fn needed(&self, name: &str) -> Result<&str> {
        self.attribute(name).ok_or_else(|| self.wrong(format!("no attribute {name}, expected one")))
    }

    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>> {
        self.attribute(name).map(|text| self.one(name, text)).transpose()
    }

    pub(crate) fn vector(&self, name: &str) -> Result<Option<DVec3>> {
        let text = self.attribute(name);
        text.map(|text| Ok(DVec3::from_array(self.numbers(name, text)?))).transpose()
    }

    pub(crate) fn one(&self, name: &str, text: &str) -> Result<f64> {
        let [number] = self.numbers(name, text)?;
        Ok(number)
    }

    /// Exactly N numbers of an attribute.
    pub(crate) fn numbers<const N: usize>(&self, name: &str, text: &str) -> Result<[f64; N]> {
        let numbers = self.list(name, text, N)?;
        let count = numbers.len();
        let expected = if N == 1 { "1 number".to_owned() } else { format!("{N} numbers") };
        numbers.try_into().map_err(|_| self.wrong(format!("{name}={} has {count} numbers, expected {expected}", quoted(text))))
    }

    /// Up to `most` numbers of an attribute, at least one. One more shows that there are too many.
    pub(crate) fn list(&self, name: &str, text: &str, most: usize) -> Result<Vec<f64>> {
        let number = |word: &str| {
            let number = word.parse::<f64>().ok().filter(|number| number.is_finite() && number.abs() <= 1e15);
            number.ok_or_else(|| {
                self.wrong(format!("{name}={} has {}, expected a number of at most 1e15", quoted(text), quoted(word)))
            })
        };
        let words = text.split(|letter: char| letter.is_whitespace()).filter(|word| !word.is_empty());
        let numbers: Vec<f64> = words.take(most.saturating_add(1)).map(number).collect::<Result<_>>()?;
        if numbers.is_empty() {
            return Err(self.wrong(format!("{name} is empty, expected numbers")));
        }
        Ok(numbers)
    }
}

/// A text with escapes in place of control characters, which a terminal would obey.
fn without_controls(text: &str) -> String {
    let escaped = |letter: char| if letter.is_control() { letter.escape_default().to_string() } else { letter.to_string() };
    text.chars().map(escaped).collect()
}

/// A value in quotation marks, shortened.
pub(crate) fn quoted(value: &str) -> String {
    format!("{:?}", shortened(value))
}

fn shortened(value: &str) -> String {
    match value.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}...", &value[..end]),
        None => value.to_owned(),
    }
}

/// The path of a file that another one names. Absolute paths and addresses are refused.
pub(crate) fn beside(element: &Element, folder: &Path, name: &str) -> Result<PathBuf> {
    let is_address = name.contains("://") || name.starts_with("file:");
    if name.is_empty() || is_address || Path::new(name).is_absolute() || name.starts_with('\\') {
        return Err(element.wrong(format!("{} is no path that is relative to the file, expected one", quoted(name))));
    }
    Ok(folder.join(name.replace('\\', "/")))
}
