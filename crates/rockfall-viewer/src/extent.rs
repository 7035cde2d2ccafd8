//! Axis-aligned bounding boxes of objects.

use rockfall::glam::Vec3;
use rockfall::{Polygon, Scene, Sphere};

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Extent {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Extent {
    pub(crate) fn of(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points.into_iter().map(|point| Self { min: point, max: point }).reduce(Self::with)
    }

    pub(crate) fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The extent of a ball.
    pub(crate) fn around(centre: Vec3, radius: f32) -> Self {
        Self { min: centre - radius, max: centre + radius }
    }

    /// The extent with a margin on all sides.
    pub(crate) fn grown(self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// The part of the extent that is nearest to another one, or inside of it.
    pub(crate) fn within(self, other: Self) -> Self {
        Self { min: self.min.clamp(other.min, other.max), max: self.max.clamp(other.min, other.max) }
    }

    pub(crate) fn contains(self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    pub(crate) fn overlaps(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    pub(crate) fn corners(self) -> impl Iterator<Item = Vec3> {
        let pick = |low: f32, high: f32, bits: u32, bit: u32| if bits >> bit & 1 == 1 { high } else { low };
        let Self { min, max } = self;
        (0..8).map(move |bits| Vec3::new(pick(min.x, max.x, bits, 0), pick(min.y, max.y, bits, 1), pick(min.z, max.z, bits, 2)))
    }

    /// The way from the box to a point; zero inside.
    pub(crate) fn to(self, point: Vec3) -> Vec3 {
        point - point.clamp(self.min, self.max)
    }

    pub(crate) fn size(self) -> f32 {
        (self.max - self.min).max_element()
    }
}

pub(crate) fn extent_of_spheres(scene: &Scene) -> Option<Extent> {
    let around = |sphere: &Sphere| Extent::around(scene.in_box(sphere.position), sphere.radius);
    scene.spheres().iter().map(around).reduce(Extent::with)
}

/// Extents of the boxes and polygons.
pub(crate) fn extents_of_static_objects(scene: &Scene) -> impl Iterator<Item = Extent> {
    let boxes = scene.boxes().iter().filter_map(|cuboid| {
        let [i, j, k] = cuboid.edges;
        let corner = |bits: u32| {
            let part = |bit: u32, edge: Vec3| if bits >> bit & 1 == 1 { edge } else { Vec3::ZERO };
            cuboid.corner + part(0, i) + part(1, j) + part(2, k)
        };
        Extent::of((0..8).map(corner))
    });
    boxes.chain(scene.polygons().iter().map(extent_of_polygon))
}

/// The extent of a polygon. Of a plane it is the corner.
pub(crate) fn extent_of_polygon(polygon: &Polygon) -> Extent {
    let (min, max) = polygon.bounds().unwrap_or((polygon.corner, polygon.corner));
    Extent { min, max }
}
