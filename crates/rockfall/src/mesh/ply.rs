//! Reads PLY files: the numbers x, y and z of the elements `vertex`, and the list `vertex_indices` or `vertex_index` of the elements
//! `face`. All other properties and elements are skipped.

use super::source::{AXES, Fan, Read, Soup, Words, Wrong, wrong_line};
use crate::error::MeshPlace;

mod header;
mod numbers;

use header::{Element, Encoding, Header, Property};
use numbers::Numbers;

pub(super) fn read(bytes: &[u8]) -> Read<Soup> {
    let header = Header::read(bytes)?;
    let vertices = only(&header, "vertex")?;
    let faces = only(&header, "face")?;
    let text;
    let mut numbers = match header.encoding {
        Encoding::Text => {
            text = String::from_utf8_lossy(&bytes[header.bytes..]);
            Numbers::Text(Words::new(&text, header.lines))
        }
        encoding => {
            Numbers::Binary { file: bytes, at: header.bytes, next: header.bytes, is_big: encoding == Encoding::BigEndian }
        }
    };
    let mut reader = Reader { soup: Soup::default(), greatest: (0, MeshPlace::Whole) };
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        if std::ptr::eq(element, vertices) {
            reader.vertices(element, &mut numbers)?;
        } else if std::ptr::eq(element, faces) {
            reader.faces(element, &mut numbers)?;
        } else {
            skip(element, &mut numbers)?;
        }
    }
    numbers.end()?;
    reader.finish()
}

/// The only element of this name.
fn only<'a>(header: &'a Header, name: &str) -> Read<&'a Element> {
    let mut elements = header.elements.iter().filter(|element| element.name == name);
    let first = elements.next();
    let first =
        first.ok_or_else(|| wrong_line(header.lines, format!("no element {name}, expected elements vertex and face")))?;
    match elements.next() {
        None => Ok(first),
        Some(second) => Err(wrong_line(second.line, format!("a second element {name}, expected one"))),
    }
}

/// Number of numbers of a property, which follow.
fn length(property: &Property, numbers: &mut Numbers<'_>) -> Read<u64> {
    let Some(count) = property.count else { return Ok(1) };
    let number = numbers.whole(count, "the length of a list")?;
    u64::try_from(number).map_err(|_| numbers.wrong(format!("the length of a list is {number}, expected at least 0")))
}

/// Leaves out all elements of a kind.
fn skip(element: &Element, numbers: &mut Numbers<'_>) -> Read<()> {
    for _ in 0..element.count {
        for property in &element.properties {
            skip_property(property, numbers)?;
        }
    }
    Ok(())
}

fn skip_property(property: &Property, numbers: &mut Numbers<'_>) -> Read<()> {
    let length = length(property, numbers)?;
    numbers.skip(property.scalar, length)
}

struct Reader {
    soup: Soup,
    /// The greatest index plus 1, and its place. The vertices may follow the faces.
    greatest: (u64, MeshPlace),
}

impl Reader {
    fn vertices(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Read<()> {
        let mut places = [0; 3];
        for (place, axis) in places.iter_mut().zip(AXES) {
            let found = element.properties.iter().position(|property| property.name == axis && property.count.is_none());
            *place = found.ok_or_else(|| wrong_line(element.line, format!("vertices without a property {axis}")))?;
        }
        // The header was checked: each of these has at least one byte in the file.
        self.soup.vertices.reserve_exact(element.count as usize);
        for _ in 0..element.count {
            let mut vertex = [0.0; 3];
            for (index, property) in element.properties.iter().enumerate() {
                match places.iter().position(|place| *place == index) {
                    Some(axis) => vertex[axis] = numbers.coordinate(property.scalar, AXES[axis])?,
                    None => skip_property(property, numbers)?,
                }
            }
            self.soup.vertices.push(vertex);
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element, numbers: &mut Numbers<'_>) -> Read<()> {
        let is_list = |property: &Property| {
            property.count.is_some() && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
        };
        let list = element.properties.iter().position(is_list);
        let list = list.ok_or_else(|| wrong_line(element.line, "faces without a list vertex_indices or vertex_index"))?;
        self.soup.triangles.reserve_exact(element.count as usize);
        for _ in 0..element.count {
            for (index, property) in element.properties.iter().enumerate() {
                match index == list {
                    true => self.face(property, numbers)?,
                    false => skip_property(property, numbers)?,
                }
            }
        }
        Ok(())
    }

    /// Reads a polygon as triangles that share its first vertex.
    fn face(&mut self, property: &Property, numbers: &mut Numbers<'_>) -> Read<()> {
        let length = length(property, numbers)?;
        if length < 3 {
            return Err(numbers.wrong(format!("a face with {length} vertices, expected at least 3")));
        }
        let mut fan = Fan::default();
        for _ in 0..length {
            let number = numbers.whole(property.scalar, "the index of a vertex")?;
            let index = u32::try_from(number);
            let index = index.map_err(|_| numbers.wrong(format!("the index {number} is out of range, expected one from 0")))?;
            if u64::from(index) >= self.greatest.0 {
                self.greatest = (u64::from(index) + 1, numbers.place());
            }
            fan.add(index, &mut self.soup.triangles);
        }
        Ok(())
    }

    /// The mesh, when all indices are in range.
    fn finish(self) -> Read<Soup> {
        let vertices = self.soup.vertices.len();
        let (greatest, place) = self.greatest;
        if greatest > vertices as u64 {
            let message = format!("the index {} is out of range, the file has {vertices} vertices", greatest - 1);
            return Err(Wrong { place, message });
        }
        Ok(self.soup)
    }
}
