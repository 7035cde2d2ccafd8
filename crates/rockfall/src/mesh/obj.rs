//! Reads OBJ files: the lines `v x y z` and `f a b c ...`.
//!
//! An index counts vertices from 1, or from the last vertex back if it is negative. Indices of texture coordinates and normals, which
//! follow after `/`, are ignored. `\` at the end of a line continues it on the next one.

use std::borrow::Cow;

use super::source::{AXES, Fan, Read, Soup, coordinate, lines, without_mark, wrong_line};
use crate::error::quoted;

pub(super) fn read(bytes: &[u8]) -> Read<Soup> {
    let text = String::from_utf8_lossy(without_mark(bytes));
    let mut soup = Soup::default();
    // The greatest index of a vertex, from 1, and its line. The vertex may follow later.
    let mut greatest = (0, 1);
    let mut lines = lines(&text).zip(1..);
    while let Some((line, number)) = lines.next() {
        let mut line = Cow::Borrowed(line.trim_ascii_end());
        while line.ends_with('\\') {
            line.to_mut().pop();
            let Some((next, _)) = lines.next() else { break };
            line.to_mut().push(' ');
            line.to_mut().push_str(next.trim_ascii_end());
        }
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => soup.vertices.push(vertex(words, number)?),
            Some("f") => face(words, number, &mut soup, &mut greatest)?,
            _ => (),
        }
    }
    if u64::from(greatest.0) > soup.vertices.len() as u64 {
        let message = format!("the index {} is out of range, the file has {} vertices", greatest.0, soup.vertices.len());
        return Err(wrong_line(greatest.1, message));
    }
    Ok(soup)
}

/// Reads the coordinates of a vertex. A weight or a colour may follow.
fn vertex<'a>(mut words: impl Iterator<Item = &'a str>, line: usize) -> Read<[f32; 3]> {
    let mut vertex = [0.0; 3];
    for (x, axis) in vertex.iter_mut().zip(AXES) {
        let word = words.next().ok_or_else(|| wrong_line(line, format!("{axis} of a vertex is missing, expected v x y z")))?;
        *x = coordinate(word, axis, line)?;
    }
    Ok(vertex)
}

/// Reads a polygon as triangles that share its first vertex.
fn face<'a>(words: impl Iterator<Item = &'a str>, line: usize, soup: &mut Soup, greatest: &mut (u32, usize)) -> Read<()> {
    let mut fan = Fan::default();
    for word in words {
        let index = index(word, soup.vertices.len(), line)?;
        if index > greatest.0 {
            *greatest = (index, line);
        }
        fan.add(index - 1, &mut soup.triangles);
    }
    if fan.found < 3 {
        return Err(wrong_line(line, format!("a face with {} vertices, expected at least 3", fan.found)));
    }
    Ok(())
}

/// The index of a vertex, from 1, for a word such as `3`, `3/4`, `3//5`, `3/4/5` or `-1`.
fn index(word: &str, vertices: usize, line: usize) -> Read<u32> {
    let written = word.split('/').next().unwrap_or_default();
    let expected = "expected a whole number other than 0, as in 3, 3/4, 3//5 or 3/4/5";
    let number: i64 = written.parse().map_err(|_| wrong_line(line, format!("{} is not an index, {expected}", quoted(word))))?;
    let index = if number < 0 { (vertices as i64).saturating_add(number).saturating_add(1) } else { number };
    match u32::try_from(index) {
        Ok(index) if index > 0 => Ok(index),
        _ if number == 0 => Err(wrong_line(line, format!("{} is not an index, {expected}", quoted(word)))),
        _ => Err(wrong_line(line, format!("the index {number} is out of range, {vertices} vertices precede it"))),
    }
}
