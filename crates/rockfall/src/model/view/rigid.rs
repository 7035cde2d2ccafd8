//! The rigid bodies of a view.

use std::ops::Range;

use glam::{Quat, Vec3, Vec4};

use crate::model::layout::{NO_RIGID, RIGID_WORDS, SHAPE_WORDS};
use crate::model::rigid::{Moments, Pose, times};
use crate::model::view::{Object, View};

/// A rigid body in the state that forces are evaluated in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidRecord {
    /// The centre of mass, rounded.
    pub(crate) centre: Vec3,
    /// 1 / M.
    pub(crate) inverse_mass: f32,
    /// The tensor of the inverse inertia: xx, yy, zz, xy, xz, yz.
    pub(crate) inverse_inertia: [f32; 6],
    /// The inverse of the least principal moment.
    pub(crate) greatest: f32,
    pub(crate) orientation: Quat,
    /// The greatest distance of a point of a sphere from the centre.
    pub(crate) reach: f32,
    /// First word of the shape.
    shape: usize,
    /// Words of the insertion indices of the member spheres.
    members: usize,
    count: usize,
}

impl RigidRecord {
    /// A vector times the tensor of the inverse inertia times itself.
    pub(crate) fn by_inverse_inertia(&self, v: Vec3) -> f32 {
        v.dot(self.spin_of(v))
    }

    /// The angular velocity of an angular momentum.
    pub(crate) fn spin_of(&self, momentum: Vec3) -> Vec3 {
        times(self.inverse_inertia, momentum)
    }
}

impl View<'_> {
    /// The rigid body of a sphere.
    pub(crate) fn body_of_sphere(&self, sphere: u32) -> Option<u32> {
        if self.step.layout.rigid_bodies == 0 {
            return None;
        }
        let body = self.topology[(self.step.layout.rigid_of_at + self.insertion_index(sphere)) as usize];
        (body != NO_RIGID).then_some(body)
    }

    /// Whether integrators move a sphere: it is not fixed and belongs to no rigid body.
    pub(crate) fn is_integrated(&self, sphere: u32) -> bool {
        !self.is_fixed(sphere) && self.body_of_sphere(sphere).is_none()
    }

    /// The rigid body of a sphere, or of a rod between two of its spheres.
    pub(crate) fn body_of(&self, object: Object) -> Option<u32> {
        match object {
            Object::Sphere(sphere) => self.body_of_sphere(sphere),
            Object::Rod(rod) => {
                let [one, two] = self.rod(rod).ends.map(|end| self.body_of_sphere(end));
                one.filter(|_| one == two)
            }
            Object::Cuboid(_) | Object::Polygon(_) => None,
        }
    }

    /// Whether one of two objects is a part of a rigid body.
    pub(crate) fn touches_body(&self, objects: [u32; 2]) -> bool {
        self.step.layout.rigid_bodies > 0 && objects.into_iter().any(|id| self.body_of(self.object(id)).is_some())
    }

    pub(crate) fn rigid_body(&self, body: u32) -> RigidRecord {
        let words: [u32; RIGID_WORDS as usize] = self.record(self.step.layout.rigid_at, body, RIGID_WORDS);
        let float = |place: usize| f32::from_bits(words[place]);
        RigidRecord {
            centre: Vec3::new(float(0), float(1), float(2)),
            inverse_mass: float(3),
            inverse_inertia: std::array::from_fn(|place| float(4 + place)),
            greatest: float(10),
            orientation: Quat::from_xyzw(float(14), float(15), float(16), float(17)),
            shape: words[11] as usize,
            reach: float(18),
            members: words[12] as usize,
            count: words[13] as usize,
        }
    }

    /// The principal moments of a body.
    pub(crate) fn moments(&self, body: &RigidRecord) -> Moments {
        let float = |place: usize| f32::from_bits(self.topology[body.shape + place]);
        Moments {
            middle: float(0),
            excess: Vec3::new(float(1), float(2), float(3)),
            axes: Quat::from_xyzw(float(4), float(5), float(6), float(7)),
        }
    }

    /// The insertion indices of the member spheres of a body, and their places from its centre in the coordinates of its shape.
    pub(crate) fn members(&self, body: RigidRecord) -> impl Iterator<Item = (u32, Vec3)> + '_ {
        let Range { start, end } = body.members..body.members + body.count;
        let places = self.topology[body.shape + SHAPE_WORDS as usize..].chunks_exact(3);
        let vector = |words: &[u32]| Vec3::from_array([0, 1, 2].map(|axis| f32::from_bits(words[axis])));
        self.topology[start..end].iter().copied().zip(places.map(vector))
    }

    /// Slots and rows of the spheres of a body with a pose: position and radius, velocity and inverse mass, angular momentum and inverse
    /// inertia, low part of the position.
    pub(crate) fn placed(&self, body: u32, pose: Pose) -> impl Iterator<Item = (u32, [Vec4; 4])> + '_ {
        let record = self.rigid_body(body);
        let spin = self.moments(&record).spin(pose.orientation, pose.momentum);
        self.members(record).map(move |(index, place)| {
            let slot = self.slot_of(index);
            let inverse_inertia = self.inverse_inertia(slot);
            let [position, velocity, momentum, low] = pose.member(place, spin, inverse_inertia);
            let rows = [
                position.extend(self.radius(slot)),
                velocity.extend(self.inverse_mass(slot)),
                momentum.extend(inverse_inertia),
                low.extend(0.0),
            ];
            (slot, rows)
        })
    }

    /// The memory slot of the sphere with an insertion index.
    pub(crate) fn slot_of(&self, index: u32) -> u32 {
        match self.step.layout.slots_at {
            0 => index,
            at => self.topology[(at + index) as usize],
        }
    }
}
