//! A body of a contact: a sphere, a rod, a box or a polygon of a scene.

use crate::error::Result;
use crate::scene::{BoxId, PolygonId, RodId, Scene, SphereId};

/// One of the two bodies of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Body {
    /// A sphere.
    Sphere(SphereId),
    /// A rod.
    Rod(RodId),
    /// A static box.
    Box(BoxId),
    /// A static polygon.
    Polygon(PolygonId),
}

impl Body {
    /// Name of the kind: `sphere`, `rod`, `box` or `polygon`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Sphere(_) => "sphere",
            Self::Rod(_) => "rod",
            Self::Box(_) => "box",
            Self::Polygon(_) => "polygon",
        }
    }

    /// Index of the body among those of its kind, in order of addition.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene.
    pub fn index(self, scene: &Scene) -> Result<usize> {
        match self {
            Self::Sphere(id) => scene.spheres.index(id),
            Self::Rod(id) => scene.rods.index(id),
            Self::Box(id) => scene.boxes.index(id),
            Self::Polygon(id) => scene.polygons.index(id),
        }
    }
}
