//! Triangle meshes: reading STL, OBJ and PLY files, and generated shapes.
//!
//! Every mesh passes [`Mesh::new`], whatever it comes from. So its indices are in range, its coordinates are finite, equal vertices
//! are one vertex, and no triangle is degenerate.

use std::io::Read as _;
use std::path::Path;

use glam::DVec3;

use crate::error::{Error, MeshPlace, Result, quoted};

pub(crate) mod nearest;
mod obj;
mod ply;
mod shapes;
mod source;
mod stl;
mod turn;
mod weld;

use source::{Soup, Wrong};

/// A surface of triangles.
///
/// Equal vertices are welded: vertices with the same coordinates are one vertex, and -0 counts as 0. Vertices are in the order of
/// their first use by a triangle, and every vertex is used.
///
/// A triangle is degenerate if its area is at most 1e-12 times the square of its longest edge, computed in `f64` from its `f32`
/// coordinates. This holds for triangles with two equal vertices, and for those whose vertices lie on a line. They are left out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mesh {
    /// Coordinates of the vertices, in the unit of the file times the scale.
    pub vertices: Vec<[f32; 3]>,
    /// Indices of the vertices of the triangles, from 0. Seen from outside, the vertices are counter-clockwise if they were so where
    /// the triangles come from.
    pub triangles: Vec<[u32; 3]>,
    /// Number of degenerate triangles that were left out, by [`Mesh::transformed`] as well.
    pub left_out: usize,
}

/// The format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// STL, as text or binary. Normals of facets and colours are ignored.
    Stl,
    /// Wavefront OBJ: the lines `v` and `f`. All other lines are ignored, and so are normals and texture coordinates.
    Obj,
    /// PLY, as text or binary: the elements `vertex` and `face`. All other elements and properties are ignored.
    Ply,
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Stl, Self::Obj, Self::Ply];

    /// The extension of file names, in lower case, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Obj => "obj",
            Self::Ply => "ply",
        }
    }

    /// The format that the extension of a file name stands for, in any case. `None` if it stands for none.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// What messages call a mesh that has no file name.
    fn title(self) -> &'static str {
        match self {
            Self::Stl => "STL mesh",
            Self::Obj => "OBJ mesh",
            Self::Ply => "PLY mesh",
        }
    }
}

/// Size of the largest file that is read, in bytes.
const LARGEST_FILE: u64 = 4 << 30;

/// Reads a file that has an end. A scene of a stranger may name a device, a pipe or a file that grows.
fn bytes_of(path: &Path) -> Result<Vec<u8>> {
    let failed = |source| Error::File { file: path.to_owned(), source };
    let wrong = |message| Error::Mesh { file: path.to_owned(), place: MeshPlace::Whole, message };
    // Before it is opened, because opening a pipe waits for its other end.
    let found = std::fs::metadata(path).map_err(failed)?;
    if !found.is_file() {
        return Err(wrong("a folder, a device or a pipe, expected a regular file".to_owned()));
    }
    if found.len() > LARGEST_FILE {
        return Err(wrong(format!("{} bytes, expected at most {LARGEST_FILE}", found.len())));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(LARGEST_FILE).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

impl Mesh {
    /// Makes a mesh of vertices and of triangles with indices from 0. Welds equal vertices, and leaves out degenerate triangles and
    /// vertices that no triangle uses.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a coordinate that is not finite, an index that is out of range, and when no triangle remains.
    pub fn new(vertices: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let invalid = |field, value, expected| Err(Error::Invalid { field, value, expected });
        let limit = u32::MAX as usize;
        if vertices.len() > limit || triangles.len() > limit {
            let value = format!("{} vertices and {} triangles", vertices.len(), triangles.len());
            return invalid("mesh", value, "at most 4294967295 of each");
        }
        if let Some(index) = vertices.iter().position(|vertex| !vertex.iter().all(|x| x.is_finite())) {
            let value = format!("{:?} of vertex {index}", vertices[index]);
            return invalid("mesh.vertices", value, "coordinates that are finite in f32");
        }
        if let Some(number) = triangles.iter().position(|triangle| triangle.iter().any(|at| *at as usize >= vertices.len())) {
            let value = format!("{:?} of triangle {number} with {} vertices", triangles[number], vertices.len());
            return invalid("mesh.triangles", value, "indices less than the number of vertices");
        }
        let mesh = weld::welded(&vertices, &triangles);
        match (mesh.triangles.is_empty(), mesh.left_out) {
            (false, _) => Ok(mesh),
            (true, 0) => invalid("mesh.triangles", "no triangle".to_owned(), "at least one triangle"),
            (true, all) => {
                let value = format!("a mesh whose {all} triangles are all degenerate");
                invalid("mesh.triangles", value, "at least one triangle with an area")
            }
        }
    }

    /// Reads a file. The extension of its name decides the format: `.stl`, `.obj` or `.ply`, in any case.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read. [`Error::Mesh`] for another extension, for what is not a regular file, for a file of more
    /// than 4 GiB, and as for [`Mesh::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let Some(format) = MeshFormat::of(path) else {
            let message = match path.extension() {
                Some(extension) => format!("the extension {} is unknown", quoted(&extension.to_string_lossy())),
                None => "the file name has no extension".to_owned(),
            };
            let message = format!("{message}, expected .stl, .obj or .ply");
            return Err(Error::Mesh { file: path.to_owned(), place: MeshPlace::Whole, message });
        };
        Self::parse_named(&bytes_of(path)?, format, path)
    }

    /// Reads the content of a file.
    ///
    /// Polygons with more than three vertices are divided into triangles that share the first vertex. This suits convex polygons.
    ///
    /// # Errors
    /// [`Error::Mesh`] with the line of a text or the offset of a byte, and what was expected: for a file that ends early or does not
    /// follow the format, a header that does not fit the length of the file, a coordinate that is not finite in `f32`, an index that
    /// is out of range, and a file without a triangle that is not degenerate.
    pub fn parse(bytes: &[u8], format: MeshFormat) -> Result<Self> {
        Self::parse_named(bytes, format, Path::new(format.title()))
    }

    fn parse_named(bytes: &[u8], format: MeshFormat, name: &Path) -> Result<Self> {
        let wrong = |Wrong { place, message }| Error::Mesh { file: name.to_owned(), place, message };
        let read = match format {
            MeshFormat::Stl => stl::read(bytes),
            MeshFormat::Obj => obj::read(bytes),
            MeshFormat::Ply => ply::read(bytes),
        };
        let Soup { vertices, triangles } = read.map_err(wrong)?;
        let whole = |message| wrong(Wrong { place: MeshPlace::Whole, message });
        if triangles.is_empty() {
            return Err(whole("no triangle, expected at least one".to_owned()));
        }
        Self::new(vertices, triangles).map_err(|error| whole(error.to_string()))
    }

    /// The mesh as a binary STL file. Its facets have normals of length 1, and it can be read again as an equal mesh.
    ///
    /// # Panics
    /// When an index was changed to one that is out of range.
    pub fn to_stl(&self) -> Vec<u8> {
        stl::written(self)
    }

    /// The mesh scaled, then turned about an axis through the origin, then shifted. Computed in `f64` and rounded to `f32` once. Turns
    /// by multiples of 90 degrees about a coordinate axis are exact.
    ///
    /// A negative scale mirrors the mesh at the origin. The order of the vertices of each triangle is reversed then, so that the
    /// outside stays outside. Vertices that become equal are welded, and triangles that become degenerate are left out and counted.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a scale that is 0 or not finite, an axis that is 0 or not finite, an angle or shift that is not finite,
    /// a coordinate that is not finite in `f32` afterwards, and when no triangle remains.
    pub fn transformed(&self, scale: f64, axis: DVec3, turn_degrees: f64, at: DVec3) -> Result<Self> {
        let invalid = |field, value, expected| Err(Error::Invalid { field, value, expected });
        if !(scale.is_finite() && scale != 0.0) {
            return invalid("mesh.scale", scale.to_string(), "a finite number other than 0");
        }
        let Some(turn) = turn::Turn::new(axis, turn_degrees) else {
            let usable = axis.is_finite() && axis != DVec3::ZERO;
            return match usable {
                true => invalid("mesh.turn", turn_degrees.to_string(), "a finite number of degrees"),
                false => invalid("mesh.axis", axis.to_string(), "a finite vector other than 0"),
            };
        };
        if !at.is_finite() {
            return invalid("mesh.at", at.to_string(), "a finite position");
        }
        let moved = |vertex: &[f32; 3]| rounded(turn.apply(position(*vertex) * scale) + at);
        let vertices = self.vertices.iter().map(moved).collect();
        let flipped = |[a, b, c]: [u32; 3]| if scale < 0.0 { [a, c, b] } else { [a, b, c] };
        let mesh = Self::new(vertices, self.triangles.iter().copied().map(flipped).collect())?;
        Ok(Self { left_out: self.left_out + mesh.left_out, ..mesh })
    }

    /// The least and the greatest coordinates of the vertices.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for vertex in &self.vertices {
            for (axis, x) in vertex.iter().enumerate() {
                bounds[0][axis] = bounds[0][axis].min(*x);
                bounds[1][axis] = bounds[1][axis].max(*x);
            }
        }
        bounds
    }

    /// The area of the surface, in the square of the unit of the vertices.
    ///
    /// # Panics
    /// When an index was changed to one that is out of range.
    pub fn area(&self) -> f64 {
        self.corners().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    /// The volume that a closed mesh encloses, by the divergence theorem, in the cube of the unit of the vertices. It is positive if
    /// the vertices of the triangles are counter-clockwise seen from outside, and negative if they are clockwise. The value for a mesh
    /// that is not closed has no meaning.
    ///
    /// # Panics
    /// When an index was changed to one that is out of range.
    pub fn volume(&self) -> f64 {
        // The tetrahedra end in a point near the mesh, so that little cancels in a mesh far from the origin.
        let [least, greatest] = self.bounds().map(position);
        let middle = 0.5 * (least + greatest);
        self.corners().map(|corners| corners.map(|corner| corner - middle)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// The positions of the vertices of every triangle.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [DVec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|at| position(self.vertices[at as usize])))
    }
}

fn position(vertex: [f32; 3]) -> DVec3 {
    DVec3::from_array(vertex.map(f64::from))
}

fn rounded(position: DVec3) -> [f32; 3] {
    position.to_array().map(|x| x as f32)
}

#[cfg(test)]
mod file_tests;
#[cfg(test)]
mod mesh_tests;
#[cfg(test)]
mod mutation_tests;
