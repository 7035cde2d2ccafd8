//! The distance of a point from a mesh.

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::Mesh;
use crate::mesh::nearest::on_triangle;

/// The triangles of a mesh, each with its first corner and the length of its longer edge from there.
pub(super) struct Nearest {
    triangles: Vec<([DVec3; 3], f64)>,
}

impl Nearest {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let reach = |[a, b, c]: [DVec3; 3]| a.distance(b).max(a.distance(c));
        Self { triangles: mesh.corners().map(|corners| (corners, reach(corners))).collect() }
    }

    /// The triangles that may be nearer to a point than a distance.
    pub(super) fn around(&self, point: DVec3, distance: f64) -> Self {
        let may_be = |(corners, reach): &&([DVec3; 3], f64)| corners[0].distance(point) <= reach + distance;
        Self { triangles: self.triangles.par_iter().filter(may_be).copied().collect() }
    }

    /// The distance of a point from the nearest triangle.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let mut least = f64::INFINITY;
        for (corners, reach) in &self.triangles {
            if corners[0].distance(point) - reach < least {
                least = least.min(distance(*corners, point));
            }
        }
        least
    }
}

/// The distance of a point from a triangle.
pub(super) fn distance(corners: [DVec3; 3], point: DVec3) -> f64 {
    point.distance(on_triangle(point, &corners))
}
