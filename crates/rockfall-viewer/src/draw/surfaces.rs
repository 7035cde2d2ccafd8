//! Surfaces that several polygons make up, such as meshes. A surface hides bodies as a whole, because holes of single polygons would
//! look like damage.

use std::collections::HashMap;

use rockfall::Polygon;

use crate::extent::{Extent, extent_of_polygon};

/// Distance up to which two vertices are one, divided by the extent of all polygons.
const SAME: f32 = 1e-5;

/// The side of a surface that the camera sees: the polygons of a surface whose normals point towards it, or away from it.
#[derive(Clone, Debug, Default)]
pub(super) struct Side {
    /// Whether each body is hidden by a polygon of the side.
    hidden: Vec<bool>,
    /// Number of bodies that lie on the side as on a floor.
    carried: usize,
}

impl Side {
    /// Adds a polygon that hides some of a number of bodies and carries others.
    pub(super) fn add(&mut self, bodies: usize, hidden: &[usize], carried: usize) {
        self.hidden.resize(bodies, false);
        hidden.iter().for_each(|body| self.hidden[*body] = true);
        self.carried += carried;
    }

    /// Whether the side hides more than a share of the bodies, and more than lie on it.
    pub(super) fn hides(&self, share: f32) -> bool {
        let hidden = self.hidden.iter().filter(|hidden| **hidden).count();
        hidden > self.carried && hidden as f32 > share * self.hidden.len() as f32
    }
}

/// Returns the number of the surface that each polygon is part of. Polygons of a surface are connected by common vertices.
pub(super) fn surfaces(polygons: &[Polygon]) -> Vec<usize> {
    let mut parents: Vec<usize> = (0..polygons.len()).collect();
    let mut owners: HashMap<[i64; 3], usize> = HashMap::new();
    let flat = || polygons.iter().enumerate().filter(|(_, polygon)| !polygon.surface.is_smooth());
    let extent = flat().map(|(_, polygon)| extent_of_polygon(polygon)).reduce(Extent::with);
    let cell = SAME * extent.map_or(1.0, Extent::size).max(f32::MIN_POSITIVE);
    for (number, polygon) in flat() {
        for vertex in polygon.vertices() {
            let place = vertex.to_array().map(|part| (part / cell).round() as i64);
            let other = *owners.entry(place).or_insert(number);
            let [one, other] = [number, other].map(|polygon| root(&mut parents, polygon));
            parents[one.max(other)] = one.min(other);
        }
    }
    (0..polygons.len()).map(|polygon| root(&mut parents, polygon)).collect()
}

fn root(parents: &mut [usize], mut polygon: usize) -> usize {
    while parents[polygon] != polygon {
        parents[polygon] = parents[parents[polygon]];
        polygon = parents[polygon];
    }
    polygon
}
