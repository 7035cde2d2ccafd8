//! The numbers by which Python refers to objects.

use pyo3::exceptions::PyLookupError;
use pyo3::prelude::*;
use rockfall::{Body, BoxId, CapsuleId, MaterialId, PolygonId, RigidBodyId, RodId, ShapeId, SphereId, SpringId, TetherId};

/// The handles of all objects that were ever added, by kind. The position in a list is the number that Python sees. It is never
/// given to another object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ids {
    pub(crate) spheres: Vec<SphereId>,
    pub(crate) rods: Vec<RodId>,
    pub(crate) capsules: Vec<CapsuleId>,
    pub(crate) springs: Vec<SpringId>,
    pub(crate) tethers: Vec<TetherId>,
    pub(crate) boxes: Vec<BoxId>,
    pub(crate) polygons: Vec<PolygonId>,
    pub(crate) materials: Vec<MaterialId>,
    pub(crate) shapes: Vec<ShapeId>,
    pub(crate) bodies: Vec<RigidBodyId>,
}

impl Ids {
    /// Numbers the objects of a scene in order of addition.
    pub(crate) fn of(scene: &rockfall::Scene) -> Self {
        Self {
            spheres: scene.sphere_ids().collect(),
            rods: scene.rod_ids().collect(),
            capsules: scene.capsule_ids().collect(),
            springs: scene.spring_ids().collect(),
            tethers: scene.tether_ids().collect(),
            boxes: scene.box_ids().collect(),
            polygons: scene.polygon_ids().collect(),
            materials: scene.material_ids().collect(),
            shapes: scene.shape_ids().collect(),
            bodies: scene.body_ids().collect(),
        }
    }
}

impl Ids {
    /// Numbers the spheres that came in through inlets since the last call and are still there.
    pub(crate) fn add_incoming(&mut self, scene: &rockfall::Scene) {
        if scene.inlets().is_empty() {
            return;
        }
        // They were added after all others.
        let last = self.spheres.iter().rev().find_map(|id| Body::Sphere(*id).index(scene).ok());
        self.spheres.extend(scene.sphere_ids().skip(last.map_or(0, |index| index + 1)));
    }
}

/// The handle with a number.
pub(crate) fn handle<T: Copy>(handles: &[T], kind: &str, id: i64) -> PyResult<T> {
    let found = usize::try_from(id).ok().and_then(|place| handles.get(place));
    let plural = match kind {
        "box" => "boxes".to_owned(),
        "body" => "bodies".to_owned(),
        _ => format!("{kind}s"),
    };
    found
        .copied()
        .ok_or_else(|| PyLookupError::new_err(format!("there is no {kind} {id}: expected a number that add_{plural} returned")))
}
