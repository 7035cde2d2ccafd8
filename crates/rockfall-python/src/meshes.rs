//! Triangle meshes as walls.

use std::path::PathBuf;

use pyo3::prelude::*;
use rockfall::glam::DVec3;
use rockfall::{Mesh, Polygon};

use crate::arguments::Rows;
use crate::doors::with;
use crate::errors::Raise;
use crate::materials::materials_of;

/// How a mesh is scaled, turned by degrees about an axis, and moved.
type Place = (f64, [f64; 3], f64, [f64; 3]);

fn transformed(mesh: &Mesh, (scale, axis, turn, at): Place) -> PyResult<Mesh> {
    mesh.transformed(scale, DVec3::from_array(axis), turn, DVec3::from_array(at)).or_raise()
}

/// Adds the triangles of a file, or of vertices and triangles. Returns the number of the first, their count, and the number of triangles
/// that were left out.
#[pyfunction]
pub(crate) fn add_mesh(
    target: &Bound<'_, PyAny>,
    file: Option<PathBuf>,
    vertices: Rows<'_>,
    triangles: Vec<[u32; 3]>,
    place: Place,
    group: u16,
    material: i64,
) -> PyResult<(usize, usize, usize)> {
    let vertices = vertices.as_slice()?.as_chunks::<3>().0.to_vec();
    with(target, |doors, ids| {
        let mesh = match file {
            Some(file) => Mesh::read(file).or_raise()?,
            None => Mesh::new(vertices, triangles).or_raise()?,
        };
        let mesh = transformed(&mesh, place)?;
        let material = materials_of(ids, &[material])?[0];
        let facets = doors.add_mesh(&mesh, &|triangle: Polygon| {
            let mut triangle = triangle.group(group);
            triangle.material = material;
            triangle
        });
        let facets = facets.or_raise()?;
        let first = ids.polygons.len();
        ids.polygons.extend(&facets.ids);
        Ok((first, facets.ids.len(), mesh.left_out + facets.left_out))
    })
}
