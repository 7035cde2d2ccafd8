//! The numbers by which Python refers to objects.

use pyo3::exceptions::PyLookupError;
use pyo3::prelude::*;
use rockfall::{BoxId, CapsuleId, JointId, MaterialId, PolygonId, RigidBodyId, RodId, ShapeId, SphereId, SpringId, TetherId};

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
    pub(crate) joints: Vec<JointId>,
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
            joints: scene.joint_ids().collect(),
        }
    }
}

impl Ids {
    /// Numbers the spheres and rigid bodies that came in through inlets since the last call and are still there.
    pub(crate) fn add_incoming(&mut self, scene: &rockfall::Scene) {
        if scene.inlets().is_empty() {
            return;
        }
        add_new(&mut self.spheres, scene.sphere_ids(), |id| scene.sphere(id).is_ok());
        add_new(&mut self.rods, scene.rod_ids(), |id| scene.rod(id).is_ok());
        add_new(&mut self.bodies, scene.body_ids(), |id| scene.body(id).is_ok());
    }
}

/// Adds those handles of a scene that are not known. They were added to the scene after all others.
fn add_new<T: Copy + Eq>(known: &mut Vec<T>, scene: impl Iterator<Item = T>, is_there: impl Fn(T) -> bool) {
    match known.iter().rev().copied().find(|id| is_there(*id)) {
        Some(last) => known.extend(scene.skip_while(|id| *id != last).skip(1)),
        None => known.extend(scene),
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
