//! Rigid bodies that are moved back to the time of a lone collision and forward again (docs/physics section 3.11).

use glam::{Quat, Vec3};

use crate::model::impulse::{BodyMove, BodyPush};
use crate::model::rigid::Moments;
use crate::model::view::{Object, RigidRecord, View};
use crate::physics::collision::body::Part;
use crate::physics::forces::attached::attached_force;
use crate::physics::rigid::{lever, velocity_of};
use crate::rotate::{product, rotated};

/// A rigid body in the present state, and the part of it that is touched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    body: u32,
    record: RigidRecord,
    moments: Moments,
    /// Velocity of the centre of mass.
    velocity: Vec3,
    momentum: Vec3,
    /// The touched sphere, or the ends of the touched rod.
    spheres: [u32; 2],
}

impl Turning {
    /// The body of a sphere or rod that is touched at a parameter. `None` for other objects.
    pub(super) fn of(view: &View, object: Object, parameter: f32) -> Option<Self> {
        let body = view.body_of(object)?;
        let spheres = match object {
            Object::Sphere(sphere) => [sphere; 2],
            Object::Rod(rod) => view.rod(rod).ends,
            Object::Cuboid(_) | Object::Polygon(_) => return None,
        };
        let record = view.rigid_body(body);
        let moments = view.moments(&record);
        let spin = view.spin(spheres[0]);
        let velocity = velocity_of(view, view, object, parameter) - spin.cross(lever(view, view, &record, object, parameter));
        Some(Self { body, record, moments, velocity, momentum: moments.momentum(record.orientation, spin), spheres })
    }

    pub(super) fn body(&self) -> u32 {
        self.body
    }

    /// The acceleration of the centre of mass by springs, tethers and external forces.
    pub(super) fn pull(&self, view: &View) -> Vec3 {
        if view.step.layout.free_at == 0 {
            return Vec3::ZERO;
        }
        let members = view.members(self.record).map(|(index, _)| attached_force(view, view.slot_of(index)));
        self.record.inverse_mass * members.sum::<Vec3>()
    }

    /// The body with the centre of mass displaced, as it has turned at a time before the present.
    pub(super) fn before(&self, time: f32, displaced: Vec3) -> RigidRecord {
        let mut before = self.record;
        before.centre += displaced;
        before.orientation = self.moments.turned(self.record.orientation, self.momentum, -time);
        before.inverse_inertia = self.moments.inverse_inertia(before.orientation);
        before
    }

    /// The touched spheres in the state `before`: their displacements from the present, and their velocities. `velocity` is the change of that
    /// of the centre of mass.
    pub(super) fn spheres(&self, view: &View, before: &RigidRecord, velocity: Vec3) -> [(u32, Vec3, Vec3); 2] {
        let turn = product(before.orientation, self.record.orientation.conjugate());
        let (moved, spin) = (before.centre - self.record.centre, before.spin_of(self.momentum));
        self.spheres.map(|sphere| {
            let now = view.position(sphere) - self.record.centre;
            let then = rotated(turn, now);
            (sphere, moved + (then - now), self.velocity + velocity + spin.cross(then))
        })
    }

    pub(super) fn velocity(&self) -> Vec3 {
        self.velocity
    }

    /// The changes of the velocities of the spheres by the impulse `push` at a time before the present, with the present levers.
    pub(super) fn velocities<'a>(
        &'a self,
        view: &'a View,
        part: &Part,
        push: Vec3,
        time: f32,
    ) -> impl Iterator<Item = (u32, Vec3)> + 'a {
        let spin = self.before(time, Vec3::ZERO).spin_of(part.sign * part.torque);
        let velocity = self.record.inverse_mass * push;
        view.members(self.record).map(move |(index, _)| {
            let sphere = view.slot_of(index);
            (sphere, velocity + spin.cross(view.position(sphere) - self.record.centre))
        })
    }

    /// What the impulse `push`, with this torque about the centre of mass, does at a time before the present.
    pub(super) fn pushed(&self, push: Vec3, torque: Vec3, time: f32) -> BodyPush {
        let velocity = self.record.inverse_mass * push;
        let before: Quat = self.before(time, Vec3::ZERO).orientation;
        let orientation = self.moments.turned(before, self.momentum + torque, time);
        let moved = Some(BodyMove { by: time * velocity, orientation });
        BodyPush { body: self.body, velocity, angular_momentum: torque, moved }
    }
}
