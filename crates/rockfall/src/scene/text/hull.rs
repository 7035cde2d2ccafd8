//! The line `@hull`, a convex hull of the body between `@body` and `@end`.

use std::path::Path;

use glam::Vec3;

use super::Reader;
use super::line::{HULL, Line, Wrong};
use super::motion::vector;
use super::values::Values;
use crate::error::quoted;
use crate::mesh::MeshFormat;

const KEYS: [&str; 4] = ["scale", "at", "axis", "turn"];

impl Reader<'_> {
    /// Reads the points, or the vertices of a file, and adds their hull to the body.
    pub(super) fn body_hull(&mut self, line: &str) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(first) = words.next() else {
            return Err(HULL.wrong("points", format!("missing, expected {}", HULL.form())));
        };
        let is_file = MeshFormat::of(Path::new(first)).is_some() || !first.contains(',');
        let points = if is_file { self.vertices_of_file(first, line)? } else { points(line)? };
        let mut added = Ok(());
        self.change_shape(|mut shape| {
            added = shape.push_hull(points);
            shape
        });
        added.map_err(|error| {
            let Wrong { field, message } = HULL.refused(&error);
            Wrong { field: field.replace("hull.", ""), message }
        })
    }

    fn vertices_of_file(&self, file: &str, line: &str) -> Line<Vec<Vec3>> {
        let words = || line.split_ascii_whitespace().skip(2);
        if let Some(word) = words().find(|word| !word.contains('=')) {
            let message = format!("expected KEY=VALUE with a key of {}; the name of the file has no spaces", KEYS.join(", "));
            return Err(HULL.wrong(&quoted(word), message));
        }
        let mesh = self.read_mesh(file, &Values::read(&HULL, &KEYS, words())?)?;
        Ok(mesh.vertices.into_iter().map(Vec3::from_array).collect())
    }
}

fn points(line: &str) -> Line<Vec<Vec3>> {
    let words = line.split_ascii_whitespace().skip(1).enumerate();
    words.map(|(number, word)| Ok(vector(&HULL, &format!("point {number}"), word)?.as_vec3())).collect()
}

#[cfg(test)]
#[path = "hull_tests.rs"]
mod tests;
