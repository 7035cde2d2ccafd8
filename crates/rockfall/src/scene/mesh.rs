//! Triangle meshes as walls.

use std::cmp::Ordering;

use glam::Vec3;

use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::scene::Scene;
use crate::scene::statics::{Polygon, PolygonId};

/// The triangles of a mesh in a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facets {
    /// The triangles, sorted by their coordinates.
    pub ids: Vec<PolygonId>,
    /// Number of triangles that were left out: two of their edges are parallel within 1e-4 rad.
    pub left_out: usize,
}

impl Scene {
    /// Adds the triangles of a mesh as walls, which can be touched from both sides. `with` gives each of them its group, material and
    /// motion, for example `|triangle| triangle.material(steel).motion(drum)`.
    ///
    /// Results depend neither on the order of the triangles in the mesh nor on that of their vertices: a triangle begins at the vertex
    /// opposite its longest edge, and triangles are added in the order of their coordinates.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an index of a vertex that does not exist, for coordinates that are not finite, for edges that are shorter
    /// than 1e-15 or longer than 1e15, for a group, material or motion that a polygon may not have, and when no triangle remains.
    pub fn add_mesh(&mut self, mesh: &Mesh, with: impl Fn(Polygon) -> Polygon) -> Result<Facets> {
        let vertex = |at: u32| mesh.vertices.get(at as usize).copied().map(Vec3::from_array);
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        let mut left_out = 0;
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let [Some(a), Some(b), Some(c)] = triangle.map(vertex) else {
                let value = format!("{triangle:?} of triangle {number} with {} vertices", mesh.vertices.len());
                return Err(Error::Invalid {
                    field: "mesh.triangles",
                    value,
                    expected: "indices less than the number of vertices",
                });
            };
            match from_widest_corner([a, b, c]) {
                Some(polygon) => triangles.push(polygon),
                None => left_out += 1,
            }
        }
        if triangles.is_empty() {
            let value = format!("{left_out} triangles without an area");
            return Err(Error::Invalid { field: "mesh.triangles", value, expected: "at least one triangle with an area" });
        }
        triangles.sort_by(order);
        let before = self.polygons.len();
        let added: Result<Vec<PolygonId>> = triangles.into_iter().map(|triangle| self.add_polygon(with(triangle))).collect();
        if added.is_err() {
            // All or nothing.
            let new: Vec<PolygonId> = self.polygon_ids().skip(before).collect();
            self.remove_polygons(&new)?;
        }
        Ok(Facets { ids: added?, left_out })
    }
}

/// The triangle from the vertex opposite its longest edge, where its angle is greatest; of equal edges, from the vertex with the
/// smallest coordinates. `None` if two edges are parallel there.
fn from_widest_corner(vertices: [Vec3; 3]) -> Option<Polygon> {
    let opposite = |k: usize| (vertices[(k + 2) % 3] - vertices[(k + 1) % 3]).length_squared();
    let by_coordinates = |one: usize, other: usize| compare(&[vertices[other]], &[vertices[one]]);
    let first = (0..3).max_by(|one, other| opposite(*one).total_cmp(&opposite(*other)).then(by_coordinates(*one, *other)))?;
    let [a, b, c] = [0, 1, 2].map(|k| vertices[(first + k) % 3]);
    Some(Polygon::triangle(a, b, c)).filter(|polygon| !polygon.has_parallel_edges())
}

fn order(one: &Polygon, other: &Polygon) -> Ordering {
    compare(&[one.corner, one.left, one.right], &[other.corner, other.left, other.right])
}

/// Compares the coordinates of vectors one after the other.
fn compare(one: &[Vec3], other: &[Vec3]) -> Ordering {
    let [one, other] = [one, other].map(|vectors| vectors.iter().flat_map(|vector| vector.to_array()));
    one.zip(other).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
#[path = "mesh_tests.rs"]
mod tests;
