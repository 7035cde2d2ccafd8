//! The line `@mesh`, which reads a file of triangles.

use std::path::Path;

use glam::DVec3;

use super::line::{Line, MESH};
use super::motion::{number, vector};
use super::{LineWarning, Reader};
use crate::error::{nearest, quoted};
use crate::mesh::Mesh;
use crate::scene::{Polygon, Tag, shared};

const KEYS: [&str; 5] = ["scale", "at", "axis", "turn", "name"];

/// What a line says about the mesh.
struct Place {
    scale: f64,
    at: DVec3,
    axis: DVec3,
    turn: f64,
    name: Option<String>,
}

impl Reader<'_> {
    pub(super) fn mesh(&mut self, line: &str, number: usize) -> Line<()> {
        let mut words = line.split_ascii_whitespace().skip(1);
        let Some(file) = words.next() else {
            return self.not_understood(number, MESH.wrong("FILE", format!("missing, expected {}", MESH.form())));
        };
        let place = read(words)?;
        let path = self.folder.join(Path::new(file));
        let mesh = Mesh::read(&path).map_err(|error| MESH.wrong("FILE", error.to_string()))?;
        let at = place.at + self.offset();
        let mesh = mesh.transformed(place.scale, place.axis, place.turn, at).map_err(|error| MESH.refused(&error))?;
        let mut tag = self.tag.as_deref().cloned().unwrap_or_default();
        if let Some(name) = place.name {
            tag = Tag { name: Some(name), ..tag };
            tag.validate().map_err(|error| MESH.wrong("name", MESH.refused(&error).message))?;
        }
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
}

fn read<'a>(words: impl Iterator<Item = &'a str>) -> Line<Place> {
    let mut place = Place { scale: 1.0, at: DVec3::ZERO, axis: DVec3::Z, turn: 0.0, name: None };
    let mut given = Vec::new();
    for word in words {
        let Some((key, value)) = word.split_once('=') else {
            let message = format!("expected KEY=VALUE with a key of {}; the name of the file has no spaces", KEYS.join(", "));
            return Err(MESH.wrong(&quoted(word), message));
        };
        if !KEYS.contains(&key) {
            let known = || format!("expected one of {}", KEYS.join(", "));
            let hint = nearest(key, &KEYS).map_or_else(known, |near| format!("did you mean {near}?"));
            return Err(MESH.wrong(&quoted(key), format!("an unknown key, {hint}")));
        }
        if given.contains(&key) {
            return Err(MESH.wrong(key, "given twice in the line"));
        }
        given.push(key);
        match key {
            "scale" => place.scale = number(&MESH, key, value)?,
            "at" => place.at = vector(&MESH, key, value)?,
            "axis" => place.axis = vector(&MESH, key, value)?,
            "turn" => place.turn = number(&MESH, key, value)?,
            _ => place.name = Some(value.to_owned()),
        }
    }
    match (given.contains(&"axis"), given.contains(&"turn")) {
        (true, false) => Err(MESH.wrong("axis", "given without turn, expected both")),
        (false, true) => Err(MESH.wrong("turn", "given without axis, expected both")),
        _ => Ok(place),
    }
}

#[cfg(test)]
#[path = "mesh_tests.rs"]
mod tests;
