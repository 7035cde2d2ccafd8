//! Bodies, colliders and materials of a scene under the law `rigid`.

use glam::{IVec3, Mat3, Quat, Vec3};

use crate::rigid::groups::GroupWords;
use crate::rigid::history::History;
use crate::rigid::joints::Joints;
use crate::rigid::laws::Laws;
use crate::rigid::periods::Periods;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
use crate::rigid::springs::Springs;
use crate::rotate::product;

/// What moves a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// It never moves. Body 0 is the only one: the world.
    World,
    /// It follows prescribed velocities.
    Kinematic,
    /// Forces and contacts move it.
    Dynamic,
}

/// A body: what is integrated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    pub(crate) kind: Kind,
    /// Centre of mass and orientation. The orientation turns coordinates of the body (those of its colliders), not its principal axes.
    pub(crate) pose: Pose,
    /// In units/s.
    pub(crate) velocity: Vec3,
    /// Angular velocity along the axes of the world, in rad/s.
    pub(crate) spin: Vec3,
    /// Angular momentum about the centre along the axes of the world, in mass units²/s.
    pub(crate) momentum: Vec3,
    /// 1 / mass; 0 without mass.
    pub(crate) inverse_mass: f32,
    /// Principal moments of inertia, in mass units². Infinite without mass.
    pub(crate) moments: Vec3,
    /// Turns coordinates along the principal axes into those of the body.
    pub(crate) axes: Quat,
    /// Inverse of the inertia along the axes of the world, for the present pose. 0 without mass.
    pub(crate) inverse_inertia: Mat3,
    /// Greatest distance of its surface from the centre of mass, in units.
    pub(crate) radius: f32,
    /// Least edge or diameter of its colliders, in units.
    pub(crate) width: f32,
    /// External force and torque about the centre, constant in a frame. Those of springs come on top.
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
    /// Factor of the margin (docs/physics section 11), 1 at the start.
    pub(crate) margin_scale: f32,
    /// In worlds that share a frame, the number of the first body of its world; else 0. Bodies of different worlds never meet.
    pub(crate) home: u32,
    /// By how many periods its place in the scene is away from that in the box of a periodic scene.
    pub(crate) periods: IVec3,
}

/// A shape at a place of a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Collider {
    /// Number of its body.
    pub(crate) body: u32,
    /// Number of its shape.
    pub(crate) shape: u32,
    /// Its place in coordinates of the body, from the centre of mass.
    pub(crate) place: Pose,
    /// Which colliders it touches.
    pub(crate) group: GroupWords,
    /// Number of its material; 0 for none.
    pub(crate) material: u16,
    /// Velocity of its surface relative to its body, in units/s, like that of a conveyor. Along the axes of the body.
    pub(crate) surface_velocity: Vec3,
}

/// Constants of a contact: from the pair of materials, or the settings of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    /// Coefficient of Coulomb friction.
    pub(crate) friction: f32,
    /// Coefficient of restitution, 0 to 1.
    pub(crate) restitution: f32,
}

/// All bodies of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RigidWorld {
    /// Number 0 is the world. The others are in order of addition.
    pub(crate) bodies: Vec<Body>,
    pub(crate) colliders: Vec<Collider>,
    pub(crate) shapes: Vec<Shape>,
    /// Constants of materials i and j at i * materials + j, symmetric; materials count from 0, which is the lack of one.
    pub(crate) surfaces: Vec<Surface>,
    /// Number of materials, at least 1.
    pub(crate) materials: usize,
    pub(crate) springs: Springs,
    pub(crate) joints: Joints,
    pub(crate) laws: Laws,
    pub(crate) periods: Periods,
    /// Acceleration of the uniform field, in units/s².
    pub(crate) gravity: Vec3,
    /// The least edge or diameter of bodies that are still to come, in units.
    pub(crate) least_to_come: Option<f32>,
    /// What the solver keeps from frame to frame.
    pub(crate) history: History,
}

impl RigidWorld {
    /// Of each body, whether it has mass.
    pub(crate) fn with_mass(&self) -> Vec<bool> {
        self.bodies.iter().map(|body| body.inverse_mass > 0.0).collect()
    }

    /// What moves body b to its image nearest to body a. Bodies without mass are there in all images.
    pub(crate) fn image(&self, bodies: [u32; 2]) -> Vec3 {
        let [a, b] = bodies.map(|body| &self.bodies[body as usize]);
        let have_mass = a.inverse_mass > 0.0 && b.inverse_mass > 0.0;
        if have_mass { self.periods.nearest(b.pose.position - a.pose.position) } else { Vec3::ZERO }
    }

    /// Takes bodies with mass back into the box of a periodic scene.
    pub(crate) fn take_into_box(&mut self) {
        if !self.periods.any() {
            return;
        }
        for body in self.bodies.iter_mut().filter(|body| body.inverse_mass > 0.0) {
            let away = self.periods.outside(body.pose.position);
            body.pose.position -= self.periods.ways(away).as_vec3();
            body.periods += away;
        }
    }

    /// The constants of a contact of two materials.
    pub(crate) fn surface(&self, a: u16, b: u16) -> Surface {
        self.surfaces[usize::from(a) * self.materials + usize::from(b)]
    }
}

impl Body {
    /// A body without mass at rest.
    pub(crate) fn fixed(kind: Kind, pose: Pose) -> Self {
        Self {
            kind,
            pose,
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            momentum: Vec3::ZERO,
            inverse_mass: 0.0,
            moments: Vec3::INFINITY,
            axes: Quat::IDENTITY,
            inverse_inertia: Mat3::ZERO,
            radius: 0.0,
            width: 0.0,
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
            margin_scale: 1.0,
            home: 0,
            periods: IVec3::ZERO,
        }
    }

    /// A body with mass at rest. Its radius and its width are those of its colliders: the caller sets them.
    pub(crate) fn loose(pose: Pose, mass: f32, moments: Vec3, axes: Quat) -> Self {
        let mut body = Self { inverse_mass: 1.0 / mass, moments, axes, ..Self::fixed(Kind::Dynamic, pose) };
        body.inverse_inertia = body.inertia_with(moments.recip());
        body
    }

    /// Sets the angular velocity, and the momentum that belongs to it. The solver trusts the momentum.
    pub(crate) fn set_spin(&mut self, spin: Vec3) {
        self.spin = spin;
        self.momentum = if self.inverse_mass > 0.0 { self.inertia_with(self.moments) * spin } else { Vec3::ZERO };
    }

    /// The tensor with these principal values along the axes of the world.
    fn inertia_with(&self, values: Vec3) -> Mat3 {
        let axes = Mat3::from_quat(product(self.pose.turn, self.axes));
        axes * Mat3::from_diagonal(values) * axes.transpose()
    }
}
