//! Smooth walls: polygons that stand for a plane, or for a surface of revolution (docs/physics section 2.17).

use glam::{DVec3, Vec3};

use crate::error::Result;
use crate::scene::checks::invalid;
use crate::scene::statics::Polygon;
use crate::scene::surface::{ConeAxis, Surface};

/// Part of a length up to which a radius or a cosine counts as 0.
const ROUNDED: f64 = 1e-4;

impl Polygon {
    /// Creates a plane through a point, which is touched on the side of its normal (docs/physics section 2.17). The normal may have any
    /// length but 0.
    pub fn plane(at: impl Into<Vec3>, normal: impl Into<Vec3>) -> Self {
        let normal = normal.into().as_dvec3().normalize();
        let left = across(normal);
        // -0 becomes 0, so that the normal of the edges gives the same edges.
        let [left, right] = [left, normal.cross(left)].map(|edge| edge.as_vec3() + Vec3::ZERO);
        Self { surface: Surface::Plane, ..Self::new(at, left, right) }
    }

    /// Creates a cylinder without caps, which is touched from outside. The axis begins at `at` and goes into the direction of `axis`, whose
    /// length does not matter. Radius and length are in units.
    pub fn cylinder(at: impl Into<Vec3>, axis: impl Into<Vec3>, radius: f32, length: f32) -> Self {
        Self::cone(at, axis, [radius; 2], length)
    }

    /// Creates a cone without caps, which is touched from outside. The axis begins at `at` with the first radius, goes into the direction of
    /// `axis`, whose length does not matter, and ends after `length` with the second radius. One radius may be 0. All are in units.
    pub fn cone(at: impl Into<Vec3>, axis: impl Into<Vec3>, radii: [f32; 2], length: f32) -> Self {
        let (at, unit) = (at.into().as_dvec3(), axis.into().as_dvec3().normalize());
        let [near, far] = radii.map(f64::from);
        let along = f64::from(length) * unit;
        // The edge begins at the wider end, so that R is not 0.
        let (at, along, near, far) = if near >= far { (at, along, near, far) } else { (at + along, -along, far, near) };
        let out = across(unit);
        let (left, right) = (along + (far - near) * out, near * out);
        Self { surface: Surface::Cone { inside: false }, ..Self::new(at.as_vec3(), left.as_vec3(), right.as_vec3()) }
    }

    /// Creates a ball, which is touched from outside. The radius is in units.
    pub fn ball(at: impl Into<Vec3>, radius: f32) -> Self {
        Self { surface: Surface::Ball { inside: false }, ..Self::new(at, radius * Vec3::X, radius * Vec3::Y) }
    }

    /// Sets whether a cone, a cylinder or a ball is touched from inside. Other surfaces stay as they are.
    pub fn inside(mut self, inside: bool) -> Self {
        self.surface = match self.surface {
            Surface::Cone { .. } => Surface::Cone { inside },
            Surface::Ball { .. } => Surface::Ball { inside },
            other => other,
        };
        self
    }

    /// The axis of a cone or cylinder, `None` for other surfaces.
    pub fn cone_axis(&self) -> Option<ConeAxis> {
        matches!(self.surface, Surface::Cone { .. }).then(|| ConeAxis::of(self.left, self.right))
    }

    /// The least and the greatest coordinates, in units; `None` for a plane, which has no ends.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let points = |points: &mut dyn Iterator<Item = Vec3>| {
            points.fold((self.corner, self.corner), |(min, max), point| (min.min(point), max.max(point)))
        };
        match self.surface {
            Surface::Parallelogram | Surface::Triangle => Some(points(&mut self.vertices())),
            Surface::Plane => None,
            Surface::Ball { .. } => Some((self.corner - self.left.length(), self.corner + self.left.length())),
            Surface::Cone { .. } => {
                let (min, max) = ConeAxis::of(self.left, self.right).bounds();
                Some((self.corner + min, self.corner + max))
            }
        }
    }

    /// Checks the edges of a smooth wall.
    pub(super) fn validate_smooth(&self) -> Result<()> {
        let (left, right) = (self.left.as_dvec3(), self.right.as_dvec3());
        match self.surface {
            Surface::Cone { .. } if ConeAxis::of(self.left, self.right).radii[1] < -ROUNDED * right.length() => {
                Err(invalid("polygon.left", self.left.to_array(), "an edge of a cone that does not pass the axis"))
            }
            Surface::Ball { .. } => {
                let squared = left.length_squared();
                let is_right =
                    left.dot(right).abs() <= ROUNDED * squared && (right.length_squared() - squared).abs() <= ROUNDED * squared;
                let wrong =
                    || invalid("polygon.right", self.right.to_array(), "an edge as long as the first, at right angles to it");
                is_right.then_some(()).ok_or_else(wrong)
            }
            _ => Ok(()),
        }
    }
}

/// A unit vector at right angles to a unit vector: a direction of the coordinates if that is one.
fn across(unit: DVec3) -> DVec3 {
    let least = unit.abs().min_position();
    unit.cross(DVec3::AXES[least]).normalize()
}
