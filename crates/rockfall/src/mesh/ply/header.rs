//! The header of a PLY file: the format and the elements with their properties.

use super::super::source::{Read, wrong_line};
use crate::error::quoted;

/// How the numbers after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Number of bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// A property of an element: a number, or a list of numbers after their count.
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the count, of a list.
    pub(super) count: Option<Scalar>,
    pub(super) scalar: Scalar,
}

/// A kind of element.
pub(super) struct Element {
    pub(super) name: String,
    /// Number of elements of this kind.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Line of the header, from 1.
    pub(super) line: usize,
}

impl Element {
    /// The least number of bytes that an element takes: lists are empty, and words of a text have one letter and a space.
    fn least(&self, encoding: Encoding) -> u128 {
        let size = |property: &Property| property.count.unwrap_or(property.scalar).size();
        let bytes = match encoding {
            Encoding::Text => 2 * self.properties.len(),
            _ => self.properties.iter().map(size).sum(),
        };
        bytes as u128
    }
}

/// The header of a file.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Number of bytes and lines of the header.
    pub(super) bytes: usize,
    pub(super) lines: usize,
}

impl Header {
    /// Reads the header. All elements that it announces fit into the file.
    pub(super) fn read(file: &[u8]) -> Read<Self> {
        // The first end of a line shows how lines end. A binary file may continue with a byte that looks like an end.
        let end = file.iter().position(|byte| matches!(byte, b'\n' | b'\r')).filter(|end| file[..*end].trim_ascii() == b"ply");
        let end = end.ok_or_else(|| wrong_line(1, "expected a line `ply`"))?;
        let end = if file[end..].starts_with(b"\r") && !file[end..].starts_with(b"\r\n") { b'\r' } else { b'\n' };
        let mut encoding = None;
        let (mut elements, mut bytes, mut lines) = (Vec::new(), 0, 0);
        loop {
            let length = file[bytes..].iter().position(|byte| *byte == end);
            let length = length.ok_or_else(|| wrong_line(lines + 1, "the file ends early, expected a line `end_header`"))?;
            let line = String::from_utf8_lossy(&file[bytes..bytes + length]);
            (bytes, lines) = (bytes + length + 1, lines + 1);
            if line.trim_ascii() == "end_header" {
                break;
            }
            if lines > 1 {
                next(&line, lines, &mut encoding, &mut elements)?;
            }
        }
        let encoding = encoding.ok_or_else(|| wrong_line(lines, "expected a line `format` before the end of the header"))?;
        let header = Self { encoding, elements, bytes, lines };
        header.check_length(file.len())?;
        Ok(header)
    }

    /// Checks that the elements fit into the file.
    fn check_length(&self, length: usize) -> Read<()> {
        // The last word of a text needs no space.
        let spare = u128::from(self.encoding == Encoding::Text);
        let mut needed = self.bytes as u128;
        for element in &self.elements {
            needed += u128::from(element.count) * element.least(self.encoding);
            if needed > length as u128 + spare {
                let (name, count) = (quoted(&element.name), element.count);
                let message = format!("{count} elements {name} need at least {} bytes, the file has {length}", needed - spare);
                return Err(wrong_line(element.line, message));
            }
        }
        Ok(())
    }
}

/// Reads a line of the header.
fn next(text: &str, line: usize, encoding: &mut Option<Encoding>, elements: &mut Vec<Element>) -> Read<()> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    match words[..] {
        [] | ["comment" | "obj_info", ..] => (),
        ["format", name, "1.0"] => {
            *encoding = Some(match name {
                "ascii" => Encoding::Text,
                "binary_little_endian" => Encoding::LittleEndian,
                "binary_big_endian" => Encoding::BigEndian,
                _ => {
                    let expected = "expected ascii, binary_little_endian or binary_big_endian";
                    return Err(wrong_line(line, format!("unknown format {}, {expected}", quoted(name))));
                }
            });
        }
        ["format", ..] => return Err(wrong_line(line, "expected `format NAME 1.0`")),
        ["element", name, count] => {
            let not_whole = |_| wrong_line(line, format!("{} is not a number of elements", quoted(count)));
            let count = count.parse().map_err(not_whole)?;
            elements.push(Element { name: name.to_owned(), count, properties: Vec::new(), line });
        }
        ["property", ref rest @ ..] => {
            let property = property(rest, line)?;
            let element = elements.last_mut();
            let element = element.ok_or_else(|| wrong_line(line, "a property, expected a line `element` before it"))?;
            element.properties.push(property);
        }
        [word, ..] => {
            let expected = "expected format, element, property, comment, obj_info or end_header";
            return Err(wrong_line(line, format!("found {}, {expected}", quoted(word))));
        }
    }
    Ok(())
}

/// Reads the words of a property after the first one.
fn property(words: &[&str], line: usize) -> Read<Property> {
    let scalar = |name: &str| {
        let expected = "expected char, uchar, short, ushort, int, uint, float or double";
        Scalar::of(name).ok_or_else(|| wrong_line(line, format!("unknown type {}, {expected}", quoted(name))))
    };
    match *words {
        ["list", count, item, name] => {
            let (counter, item) = (scalar(count)?, scalar(item)?);
            if !counter.is_whole() {
                return Err(wrong_line(line, format!("the count of a list is a {count}, expected a type of whole numbers")));
            }
            let is_face = matches!(name, "vertex_indices" | "vertex_index");
            if is_face && !item.is_whole() {
                return Err(wrong_line(line, format!("{name} is a list of floating-point numbers, expected whole numbers")));
            }
            Ok(Property { name: name.to_owned(), count: Some(counter), scalar: item })
        }
        [kind, name] if kind != "list" => Ok(Property { name: name.to_owned(), count: None, scalar: scalar(kind)? }),
        _ => Err(wrong_line(line, "expected `property TYPE NAME` or `property list TYPE TYPE NAME`")),
    }
}
