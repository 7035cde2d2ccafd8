//! Which object a part of a contact belongs to.

use std::collections::HashMap;

use super::Party;
use crate::error::Result;
use crate::scene::{Body, CapsuleId, ObjectId, RodId, Scene, SphereId};

/// The objects of a scene.
pub(super) struct Parties<'a> {
    scene: &'a Scene,
    /// The capsules of their spheres and rods.
    capsules: HashMap<ObjectId, CapsuleId>,
}

impl<'a> Parties<'a> {
    pub(super) fn of(scene: &'a Scene) -> Self {
        let parts = scene.capsule_ids().zip(scene.capsules());
        let parts = parts.flat_map(|(id, capsule)| {
            [capsule.end1.into(), capsule.end2.into(), capsule.rod.into()].map(|part: ObjectId| (part, id))
        });
        Self { scene, capsules: parts.collect() }
    }

    /// The object that a part belongs to.
    pub(super) fn party(&self, part: Body) -> Result<Party> {
        match part {
            Body::Sphere(id) => self.of_sphere(id),
            Body::Rod(id) => self.of_rod(id),
            Body::Box(id) => Ok(Party { id: id.into(), index: part.index(self.scene)? }),
            Body::Polygon(id) => Ok(Party { id: id.into(), index: part.index(self.scene)? }),
        }
    }

    /// The object that a sphere belongs to.
    pub(super) fn of_sphere(&self, id: SphereId) -> Result<Party> {
        if let Some(body) = self.scene.body_of_sphere(id) {
            return Ok(Party { id: body.into(), index: self.scene.bodies.index(body)? });
        }
        if let Some(capsule) = self.capsules.get(&id.into()) {
            return Ok(Party { id: (*capsule).into(), index: self.scene.capsules.index(*capsule)? });
        }
        let id = self.first_of_frame(id);
        Ok(Party { id: id.into(), index: self.scene.spheres.index(id)? })
    }

    fn of_rod(&self, id: RodId) -> Result<Party> {
        if let Some(body) = self.scene.body_of_rod(id) {
            return Ok(Party { id: body.into(), index: self.scene.bodies.index(body)? });
        }
        if let Some(capsule) = self.capsules.get(&id.into()) {
            return Ok(Party { id: (*capsule).into(), index: self.scene.capsules.index(*capsule)? });
        }
        if self.scene.implied_of_rod(id).is_some() {
            return self.of_sphere(self.scene.rod(id)?.end1);
        }
        Ok(Party { id: id.into(), index: self.scene.rods.index(id)? })
    }

    /// The first sphere of the frame of rods that a sphere is part of; otherwise the sphere.
    pub(super) fn first_of_frame(&self, id: SphereId) -> SphereId {
        let frame = self.scene.implied_of(id).and_then(|frame| self.scene.implied.get(frame).ok());
        frame.and_then(|frame| frame.spheres.first().copied()).unwrap_or(id)
    }
}

/// The place of an object in the order of the two objects of an event.
pub(super) fn rank(party: &Party) -> (u8, usize) {
    let kind = match party.id {
        ObjectId::Sphere(_) => 0,
        ObjectId::Rod(_) => 1,
        ObjectId::Capsule(_) => 2,
        ObjectId::Body(_) => 3,
        ObjectId::Box(_) => 4,
        ObjectId::Polygon(_) => 5,
        ObjectId::Spring(_) => 6,
    };
    (kind, party.index)
}
