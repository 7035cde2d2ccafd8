//! Objects of any kind that can touch, and their numbers: spheres first, then rods, boxes and polygons, each in insertion order.

use crate::scene::{BoxId, PolygonId, RodId, Scene, SphereId};

/// The handle of an object that can touch others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AnyId {
    Sphere(SphereId),
    Rod(RodId),
    Box(BoxId),
    Polygon(PolygonId),
}

impl Scene {
    /// The handles of all objects that can touch, by number.
    pub(crate) fn any_ids(&self) -> Vec<AnyId> {
        let spheres = self.sphere_ids().map(AnyId::Sphere);
        let rods = self.rod_ids().map(AnyId::Rod);
        spheres.chain(rods).chain(self.box_ids().map(AnyId::Box)).chain(self.polygon_ids().map(AnyId::Polygon)).collect()
    }

    /// The number of an object; `None` if it is not in the scene.
    pub(crate) fn number_of(&self, id: AnyId) -> Option<u32> {
        let counts = self.counts();
        let (first, index) = match id {
            AnyId::Sphere(id) => (0, self.spheres.index(id)),
            AnyId::Rod(id) => (counts.spheres, self.rods.index(id)),
            AnyId::Box(id) => (counts.spheres + counts.rods, self.boxes.index(id)),
            AnyId::Polygon(id) => (counts.spheres + counts.rods + counts.boxes, self.polygons.index(id)),
        };
        index.ok().map(|index| (first + index) as u32)
    }
}
