//! Convex hulls of shapes. Only the contact law `rigid` takes them.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::solid::Part;
use super::{Shape, ShapeSphere};
use crate::error::{Error, Result};
use crate::rigid::shape::{BadHull, Hull};
use crate::scene::checks::invalid;
use crate::scene::{MaterialId, Tag};

/// Greatest absolute coordinate of a point of a hull.
const GREATEST: f32 = 1e15;

/// A convex hull of a [`Shape`], in its coordinates. Edges and corners are sharp.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeHull {
    /// The points that are vertices of the hull, in the order in which they were given.
    points: Vec<Vec3>,
    /// The hull of exactly these points, about its centre.
    pub(crate) hull: Arc<Hull>,
    /// Centre of its volume.
    pub(crate) centre: Vec3,
    group: u16,
    material: Option<MaterialId>,
    /// Name, colour, look and label, before those of the body.
    pub(crate) tag: Option<Arc<Tag>>,
}

impl ShapeHull {
    /// The vertices, in units.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The surface: triangles whose corners are counter-clockwise seen from outside, in units.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.hull.triangles().map(|triangle| triangle.map(|corner| self.centre + corner))
    }

    /// Collision group. Objects of different groups never touch.
    pub fn group(&self) -> u16 {
        self.group
    }

    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub fn material(&self) -> Option<MaterialId> {
        self.material
    }

    /// The planes of the faces: outward unit normals, and points on them from the centre.
    pub(crate) fn planes(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let plane = |(normal, corners): &(Vec3, Vec<u8>)| {
            (normal.as_dvec3().normalize(), self.hull.vertices[usize::from(corners[0])].as_dvec3())
        };
        self.hull.faces.iter().map(plane)
    }

    /// Volume in units³.
    pub(crate) fn volume(&self) -> f64 {
        self.hull.moments().0
    }

    pub(super) fn part(&self) -> Part {
        Part::hull(&self.hull, self.centre.as_dvec3())
    }

    /// The sphere about the centre that contains the hull. It stands for the hull in the scene.
    fn sphere(&self) -> ShapeSphere {
        let radius = self.hull.vertices.iter().map(|vertex| vertex.length()).fold(0.0, f32::max);
        let Self { centre, group, material, ref tag, .. } = *self;
        ShapeSphere { centre, radius, group, material, tag: tag.clone() }
    }
}

impl Shape {
    /// Adds the convex hull of at least 4 and at most 100,000 points, in units. Only the contact law `rigid` takes shapes with hulls. The
    /// group, the material and the tag are those of the shape. [`Shape::rounding`] has no effect on hulls.
    ///
    /// ```
    /// # fn main() -> rockfall::Result<()> {
    /// use rockfall::Shape;
    ///
    /// let tetrahedron = Shape::new().density(1000.0).add_hull([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
    /// assert!((tetrahedron.mass_properties_of()?.mass - 1000.0 / 6.0).abs() < 1e-3);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] for fewer than 4 or more than 100,000 points, coordinates that are not finite or greater than 1e15, points in
    /// one plane, and a hull with more than 32 faces.
    pub fn add_hull(mut self, points: impl IntoIterator<Item = impl Into<Vec3>>) -> Result<Self> {
        let points = points.into_iter().map(Into::into).collect();
        self.push_hull(points)?;
        Ok(self)
    }

    pub(crate) fn push_hull(&mut self, mut points: Vec<Vec3>) -> Result<()> {
        let refused = |BadHull { value, expected }| Error::Invalid { field: "shape.hull.points", value, expected };
        if let Some(point) = points.iter().find(|point| point.is_finite() && point.abs().max_element() > GREATEST) {
            return Err(invalid("shape.hull.points", point.to_array(), "coordinates of at most 1e15"));
        }
        // The hull of a part of the points may differ in the last digit, and a saved scene has the vertices alone.
        let (hull, centre) = loop {
            let (hull, centre, vertices) = Hull::with_numbers(&points).map_err(refused)?;
            if vertices.len() == points.len() {
                break (Arc::new(hull), centre);
            }
            points = vertices.into_iter().map(|number| points[number]).collect();
        };
        let (group, material, tag) = (self.group, self.material, self.tag.clone());
        self.hulls.push(ShapeHull { points, hull, centre, group, material, tag });
        Ok(())
    }

    /// The spheres that stand for the hulls.
    pub(super) fn spheres_of_hulls(&self) -> impl Iterator<Item = ShapeSphere> {
        self.hulls.iter().map(ShapeHull::sphere)
    }

    /// Number of the first sphere of [`Shape::all_spheres`] that stands for a hull.
    pub(crate) fn first_hull(&self) -> usize {
        self.spheres.len() + self.boxes.len()
    }

    /// The number of the hull that a sphere of [`Shape::all_spheres`] stands for.
    pub(crate) fn hull_of_sphere(&self, sphere: usize) -> Option<usize> {
        sphere.checked_sub(self.first_hull()).filter(|number| *number < self.hulls.len())
    }

    /// The greatest distance of a vertex of a hull from a point; 0 without hulls.
    pub(super) fn reach_of_hulls(&self, centre: DVec3) -> f64 {
        let points = self.hulls.iter().flat_map(|hull| &hull.points);
        points.map(|point| point.as_dvec3().distance(centre)).fold(0.0, f64::max)
    }
}

#[cfg(test)]
#[path = "hull_tests.rs"]
mod tests;
