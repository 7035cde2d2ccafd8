//! `<asset><mesh>`.

use std::path::Path;
use std::sync::Arc;

use rockfall::Mesh;
use rockfall::glam::DVec3;

use super::Mjcf;
use super::defaults::Defaults;
use crate::assets;
use crate::error::Result;
use crate::solid::{Points, surface};
use crate::xml::{Element, beside, quoted};

/// Greatest number of coordinates of a mesh that is part of the file.
const MOST: usize = 300_000;

impl Mjcf<'_> {
    /// Keeps the mesh elements. Files are read when a geom has the mesh.
    pub(super) fn read_meshes(&mut self, root: &Element) -> Result<()> {
        for asset in root.all("asset") {
            for mesh in asset.all("mesh") {
                let stem = || Path::new(mesh.attribute("file")?).file_stem()?.to_str();
                let Some(name) = mesh.attribute("name").or_else(stem) else {
                    return Err(mesh.wrong("neither name nor file, expected one of them"));
                };
                self.meshes.insert(name.to_owned(), mesh.alone());
            }
        }
        Ok(())
    }

    /// The vertices of the mesh of a geom. `None`, with a note, where it cannot be read.
    pub(super) fn mesh(&mut self, geom: &Element, name: &str) -> Result<Option<Arc<Points>>> {
        let Some(element) = self.meshes.get(name).cloned() else {
            return Err(geom.wrong(format!("no mesh has the name {}, expected that of an asset", quoted(name))));
        };
        let of = self.defaults.attributes(&element, Defaults::MAIN)?;
        let scale = of.vector("scale")?.unwrap_or(DVec3::ONE);
        for key in ["refpos", "refquat"] {
            if of.get(key).is_some() {
                self.notes.ignored_attribute(&element, key);
            }
        }
        if let Some(text) = element.attribute("vertex") {
            let numbers = element.list("vertex", text, MOST)?;
            let points: Vec<DVec3> = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
            let Some((corners, triangles)) = surface(&points) else {
                self.notes.add(&element, "the mesh is left out: the engine does not take the hull of its vertices");
                return Ok(None);
            };
            let mesh = Mesh::new(corners.iter().map(|corner| corner.as_vec3().to_array()).collect(), triangles);
            let mesh = mesh.map_err(|error| element.wrong(error.to_string()))?;
            return assets::scaled(&element, name, mesh, scale, &mut self.notes);
        }
        let Some(file) = element.attribute("file") else {
            self.notes.add(&element, "the mesh is left out: it has neither a file nor vertices");
            return Ok(None);
        };
        let name = if self.compiler.strips_paths { file.rsplit(['/', '\\']).next().unwrap_or(file) } else { file };
        let folder = match self.compiler.mesh_folder.as_str() {
            "" => self.folder(),
            folder => beside(&element, &self.folder(), folder)?,
        };
        let path = beside(&element, &folder, name)?;
        self.assets.mesh(&element, &path, scale, &mut self.notes)
    }
}
