//! Reads and writes STL files.
//!
//! A binary file has a header of 80 bytes with any content, the number n of facets as u32, and n facets of 50 bytes: normal and three
//! vertices as f32, and two more bytes. All numbers are little-endian. A text has the words
//! `solid NAME facet normal x y z outer loop vertex x y z vertex x y z vertex x y z endloop endfacet ... endsolid NAME`, in any case.
//!
//! Many programs begin the header of a binary file with `solid`. So the length decides first.

use super::source::{AXES, Read, Soup, Words, coordinate, without_mark, wrong_byte};
use super::{Mesh, position, rounded};
use crate::error::quoted;

/// Number of bytes before the first facet, and of the header without the number of facets.
const START: usize = 84;
const HEADER: usize = 80;
/// Number of bytes of a facet.
const FACET: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Read<Soup> {
    let facets = bytes.get(HEADER..START).and_then(|count| Some(u32::from_le_bytes(count.try_into().ok()?)));
    let length = facets.map(|facets| u64::from(facets) * FACET as u64 + START as u64);
    if let Some(facets) = facets.filter(|_| length == Some(bytes.len() as u64)) {
        return binary(bytes, facets);
    }
    let text = without_mark(bytes).trim_ascii_start();
    // No text has NUL bytes, but most binary files do.
    if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !bytes.contains(&0) {
        return self::text(&String::from_utf8_lossy(without_mark(bytes)));
    }
    Err(match (facets, length) {
        (Some(facets), Some(length)) => {
            let message = format!(
                "neither a text that begins with solid nor a binary file: {facets} facets would need {length} bytes, the file has {}",
                bytes.len()
            );
            wrong_byte(HEADER, message)
        }
        _ => wrong_byte(0, format!("expected a text that begins with solid, or at least {START} bytes, found {}", bytes.len())),
    })
}

/// Reads a binary file. Its length fits the number of facets.
fn binary(bytes: &[u8], facets: u32) -> Read<Soup> {
    if facets > u32::MAX / 3 {
        return Err(wrong_byte(HEADER, format!("{facets} facets, expected at most {}", u32::MAX / 3)));
    }
    let mut soup = Soup::default();
    soup.vertices.reserve_exact(3 * facets as usize);
    soup.triangles.reserve_exact(facets as usize);
    for (number, facet) in bytes[START..].chunks_exact(FACET).enumerate() {
        let (words, _) = facet[12..48].as_chunks::<4>();
        for (corner, words) in words.chunks_exact(3).enumerate() {
            let vertex = [words[0], words[1], words[2]].map(f32::from_le_bytes);
            if let Some(axis) = vertex.iter().position(|x| !x.is_finite()) {
                let offset = START + FACET * number + 12 + 12 * corner + 4 * axis;
                let (name, value) = (AXES[axis], vertex[axis]);
                return Err(wrong_byte(offset, format!("{name} of a vertex: {value} is not finite, expected a finite number")));
            }
            soup.vertices.push(vertex);
        }
        let first = 3 * number as u32;
        soup.triangles.push([first, first + 1, first + 2]);
    }
    Ok(soup)
}

/// Reads a text of one or more solids.
fn text(text: &str) -> Read<Soup> {
    let mut words = Words::new(text, 0);
    let mut soup = Soup::default();
    while let Some(word) = words.next() {
        is(&words, word, &["solid"])?;
        words.skip_line();
        loop {
            let word = words.expect("facet or endsolid")?;
            if is(&words, word, &["facet", "endsolid"])? == "endsolid" {
                words.skip_line();
                break;
            }
            facet(&mut words, &mut soup)?;
        }
    }
    Ok(soup)
}

/// Reads a facet after its first word.
fn facet(words: &mut Words<'_>, soup: &mut Soup) -> Read<()> {
    follow(words, &["normal"])?;
    // Some programs write normals that are not numbers.
    for _ in 0..3 {
        words.expect("the normal of the facet")?;
    }
    follow(words, &["outer", "loop"])?;
    let first = u32::try_from(soup.vertices.len()).ok().filter(|first| *first <= u32::MAX - 3);
    let first = first.ok_or_else(|| words.wrong(format!("too many facets, expected at most {}", u32::MAX / 3)))?;
    for _ in 0..3 {
        follow(words, &["vertex"])?;
        let mut vertex = [0.0; 3];
        for (x, axis) in vertex.iter_mut().zip(AXES) {
            let word = words.expect("a coordinate")?;
            *x = coordinate(word, axis, words.line)?;
        }
        soup.vertices.push(vertex);
    }
    soup.triangles.push([first, first + 1, first + 2]);
    follow(words, &["endloop", "endfacet"])
}

/// Reads these words.
fn follow(words: &mut Words<'_>, expected: &[&str]) -> Read<()> {
    for name in expected {
        let word = words.expect(name)?;
        is(words, word, &[name])?;
    }
    Ok(())
}

/// The one of these names that the last word is, in any case.
fn is<'a>(words: &Words<'_>, word: &str, names: &[&'a str]) -> Read<&'a str> {
    let found = names.iter().find(|name| word.eq_ignore_ascii_case(name));
    found.copied().ok_or_else(|| words.wrong(format!("found {}, expected {}", quoted(word), names.join(" or "))))
}

/// The mesh as a binary file.
pub(super) fn written(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(START + FACET * mesh.triangles.len());
    // The text must not begin with `solid`.
    bytes.extend(b"binary STL of rockfall");
    bytes.resize(HEADER, b' ');
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        let corners = triangle.map(|at| mesh.vertices[at as usize]);
        let [a, b, c] = corners.map(position);
        let normal = rounded((b - a).cross(c - a).normalize_or_zero());
        for number in std::iter::once(normal).chain(corners).flatten() {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}
