//! Mesh files that a robot names.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rockfall::glam::DVec3;
use rockfall::{Mesh, MeshFormat};

use crate::error::{Error, Result};
use crate::notes::Notes;
use crate::solid::Points;
use crate::xml::{Element, beside, quoted};

/// Size of the largest mesh file that is read, in bytes.
const LARGEST: u64 = 256 << 20;

/// The meshes that were read, by file and scale.
#[derive(Debug, Default)]
pub(crate) struct Assets {
    read: HashMap<(PathBuf, [u64; 3]), Option<Arc<Points>>>,
}

impl Assets {
    /// Reads a mesh file. `None`, with a note, for a format that is not read and for a mesh without a volume.
    pub(crate) fn mesh(&mut self, at: &Element, path: &Path, scale: DVec3, notes: &mut Notes) -> Result<Option<Arc<Points>>> {
        let key = (path.to_owned(), scale.to_array().map(f64::to_bits));
        if let Some(known) = self.read.get(&key) {
            return Ok(known.clone());
        }
        let points = read(at, path, scale, notes)?;
        self.read.insert(key, points.clone());
        Ok(points)
    }
}

fn read(at: &Element, path: &Path, scale: DVec3, notes: &mut Notes) -> Result<Option<Arc<Points>>> {
    let failed = |source| Error::File { file: path.to_owned(), source };
    let found =
        std::fs::metadata(path).map_err(|error| at.wrong(format!("{}: {error}, expected a mesh file", path.display())))?;
    if found.len() > LARGEST {
        return Err(failed(std::io::Error::other("more than 256 MiB, expected a mesh of at most 256 MiB")));
    }
    if MeshFormat::of(path).is_none() {
        notes.add(at, format!("the mesh {} is left out: only STL, OBJ and PLY files are read", path.display()));
        return Ok(None);
    }
    let mesh = Mesh::read(path).map_err(|error| at.wrong(error.to_string()))?;
    scaled(at, &path.display().to_string(), mesh, scale, notes)
}

/// The points of a mesh whose coordinates are multiplied.
pub(crate) fn scaled(at: &Element, name: &str, mesh: Mesh, scale: DVec3, notes: &mut Notes) -> Result<Option<Arc<Points>>> {
    let scaled = |vertex: &[f32; 3]| (DVec3::from_array(vertex.map(f64::from)) * scale).as_vec3().to_array();
    let mesh = Mesh::new(mesh.vertices.iter().map(scaled).collect(), mesh.triangles);
    let mesh = mesh.map_err(|error| at.wrong(format!("the mesh {name} with its scale: {error}")))?;
    let Some(points) = Points::of(&mesh) else {
        notes.add(at, format!("the mesh {name} is left out: its vertices span no volume"));
        return Ok(None);
    };
    if points.is_reduced {
        let count = points.hull.len();
        notes.add(
            at,
            format!("the hull of the mesh {name} has {count} vertices in place of all, so that it has at most 32 faces"),
        );
    }
    Ok(Some(Arc::new(points)))
}

/// The path of a mesh of a URDF file. `package://NAME/rest` is looked for in the folders above the file.
pub(crate) fn find(at: &Element, file: &Path, name: &str) -> Result<PathBuf> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let Some(rest) = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://")) else {
        return beside(at, folder, name);
    };
    let (package, rest) = rest.split_once('/').unwrap_or((rest, ""));
    let goes_up = [package, rest].iter().any(|part| part.split('/').any(|word| word == ".."));
    if goes_up || rest.is_empty() || rest.starts_with('/') {
        return Err(at.wrong(format!("{} is no file of a package, expected package://NAME/FILE", quoted(name))));
    }
    let whole = std::path::absolute(folder).unwrap_or(folder.to_owned());
    for above in whole.ancestors() {
        let is_package = above.file_name().is_some_and(|last| last == package);
        let places = [above.join(package).join(rest), above.join(rest)];
        let found = places.into_iter().enumerate().find(|(k, path)| (*k == 0 || is_package) && path.is_file());
        if let Some((_, path)) = found {
            return Ok(path);
        }
    }
    let plain = whole.ancestors().map(|above| above.join(rest)).find(|path| path.is_file());
    plain.ok_or_else(|| {
        let message =
            format!("no file {} in a folder {} beside or above the file, expected the mesh", quoted(rest), quoted(package));
        at.wrong(message)
    })
}
