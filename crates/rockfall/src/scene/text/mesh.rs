//! The line `@mesh`, which reads a file of triangles.

use std::path::Path;

use glam::DVec3;

use super::line::{Kind, Line, MESH};
use super::values::Values;
use super::{LineWarning, Reader};
use crate::error::quoted;
use crate::mesh::Mesh;
use crate::scene::{Polygon, Tag, shared};

const KEYS: [&str; 5] = ["scale", "at", "axis", "turn", "name"];

impl Reader<'_> {
    pub(super) fn mesh(&mut self, line: &str, number: usize) -> Line<()> {
        let Some(file) = line.split_ascii_whitespace().nth(1) else {
            return self.not_understood(number, MESH.wrong("FILE", format!("missing, expected {}", MESH.form())));
        };
        let words = || line.split_ascii_whitespace().skip(2);
        if let Some(word) = words().find(|word| !word.contains('=')) {
            let message = format!("expected KEY=VALUE with a key of {}; the name of the file has no spaces", KEYS.join(", "));
            return Err(MESH.wrong(&quoted(word), message));
        }
        let values = Values::read(&MESH, &KEYS, words())?;
        let mesh = self.read_mesh(file, &values)?;
        let tag = self.tag_with_name(&MESH, &values)?;
        let (group, material, motion, surface_velocity) = (self.group, self.material, self.motion, self.surface);
        let with = |triangle| Polygon { group, material, motion, surface_velocity, ..triangle };
        let facets = self.scene.add_mesh(&mesh, with).map_err(|error| MESH.refused(&error))?;
        let tag = shared(tag);
        for id in facets.ids {
            self.scene.share_tag(id.into(), &tag).map_err(|error| MESH.refused(&error))?;
        }
        let left_out = mesh.left_out + facets.left_out;
        if left_out > 0 {
            let text = format!("{left_out} triangles of {} have no area and were left out", quoted(file));
            self.warnings.push(LineWarning { line: number, text });
        }
        Ok(())
    }

    /// Reads the file of a line with the keys `scale`, `at`, `axis` and `turn`.
    pub(super) fn read_mesh(&self, file: &str, values: &Values) -> Line<Mesh> {
        let kind = values.kind;
        let (axis, turn) = (values.vector("axis")?, values.number("turn")?);
        match (axis, turn) {
            (Some(_), None) => return Err(kind.wrong("axis", "given without turn, expected both")),
            (None, Some(_)) => return Err(kind.wrong("turn", "given without axis, expected both")),
            _ => {}
        }
        let path = self.folder.join(Path::new(file));
        let mesh = Mesh::read(&path).map_err(|error| kind.wrong("FILE", error.to_string()))?;
        let at = values.vector("at")?.unwrap_or_default() + self.offset();
        let scale = values.number("scale")?.unwrap_or(1.0);
        let turned = mesh.transformed(scale, axis.unwrap_or(DVec3::Z), turn.unwrap_or(0.0), at);
        turned.map_err(|error| kind.refused(&error))
    }

    /// The tag of the following objects, with the name of the line if it has one.
    pub(super) fn tag_with_name(&self, kind: &Kind, values: &Values) -> Line<Tag> {
        let mut tag = self.tag.as_deref().cloned().unwrap_or_default();
        if let Some(name) = values.of("name") {
            tag = Tag { name: Some(name.to_owned()), ..tag };
            tag.validate().map_err(|error| kind.wrong("name", kind.refused(&error).message))?;
        }
        Ok(tag)
    }
}

#[cfg(test)]
#[path = "mesh_tests.rs"]
mod tests;
