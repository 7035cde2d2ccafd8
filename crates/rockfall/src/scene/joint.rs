//! Joints between bodies (docs/physics section 11.14).

use std::fmt;
use std::str::FromStr;

use glam::{DVec3, Quat, Vec3};

use super::{Handle, RigidBodyId, SphereId};
use crate::error::{Error, Result, quoted};

mod check;
mod lay;
mod place;

pub(crate) use lay::name_is_taken;

/// Handle of a [`Joint`].
pub type JointId = Handle<Joint>;

/// Which motions of two bodies against each other a [`Joint`] leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum JointKind {
    /// The bodies turn about a common point.
    Ball,
    /// The bodies turn about a common axis.
    Hinge,
    /// The bodies slide along an axis and do not turn.
    Slider,
    /// The bodies keep their places against each other.
    Fixed,
    /// A point of one body keeps its distance from a point of the other one.
    Distance,
}

impl JointKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Ball, Self::Hinge, Self::Slider, Self::Fixed, Self::Distance];

    /// Whether positions of the joint are angles, as those of a hinge and a ball are.
    pub fn turns(self) -> bool {
        matches!(self, Self::Ball | Self::Hinge)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Hinge => "hinge",
            Self::Slider => "slider",
            Self::Fixed => "fixed",
            Self::Distance => "distance",
        }
    }
}

impl fmt::Display for JointKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for JointKind {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        let expected = "ball, hinge, slider, fixed or distance";
        found.ok_or_else(|| Error::Invalid { field: "joint.kind", value: quoted(name), expected })
    }
}

/// What an end of a [`Joint`] is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Anchor {
    /// The world, which does not move.
    World,
    /// A rigid body.
    Body(RigidBodyId),
    /// A sphere. One that is part of a rigid body stands for the body: [`Scene::add_joint`](crate::Scene::add_joint) replaces
    /// it by the body.
    Sphere(SphereId),
}

impl From<RigidBodyId> for Anchor {
    fn from(id: RigidBodyId) -> Self {
        Self::Body(id)
    }
}

impl From<SphereId> for Anchor {
    fn from(id: SphereId) -> Self {
        Self::Sphere(id)
    }
}

/// An end of a [`Joint`] in coordinates of its body: from the centre of mass along the axes of its shape, or from the centre of a sphere
/// along the axes of its orientation. That of the world or of a fixed sphere is in coordinates of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrame {
    /// The anchor, in units.
    pub place: Vec3,
    /// Turns coordinates of the joint into those of the body. A unit quaternion. The first axis is that of the joint.
    pub turn: Quat,
}

/// Where a joint is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Laid {
    /// In the world, with the bodies in their present places: the anchor on the first body, that on the second one, and the
    /// axis, x if there is none.
    World { at: DVec3, to: DVec3, axis: Option<DVec3> },
    /// In coordinates of the bodies.
    Ends([JointFrame; 2]),
}

/// A connection of two bodies, as a builder: `Joint::hinge(Anchor::World, door, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0]).limits(-1.5, 0.0)`.
///
/// Its **position** is the angle in rad of a hinge and of the twist of a ball about the axis, the way in units along the axis
/// of a slider, or the distance in units of the anchors of a distance joint. Angles and ways are 0 in the places of the bodies in which
/// [`Scene::add_joint`](crate::Scene::add_joint) adds the joint, and measure how the second body moves against the first one.
/// Motors, springs, friction and limits act along it. A joint of the kind fixed has none of these.
///
/// Joints need the contact law [`Rigid`](crate::ContactLaw::Rigid).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Joint {
    /// Kind.
    pub kind: JointKind,
    /// The first body.
    pub a: Anchor,
    /// The second body.
    pub b: Anchor,
    /// Name, which no other joint of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: Option<String>,
    /// Least and greatest position. That of a ball is its twist. `None` for no limits.
    pub limits: Option<[f32; 2]>,
    /// For a ball: the greatest angle in rad between the axes of both bodies. `None` for no limit.
    pub cone: Option<f32>,
    /// Speed of the motor in rad/s or units/s; `None` for no motor.
    pub speed: Option<f32>,
    /// The greatest force of the motor in mass units/s², or its torque in mass units²/s². It bounds the spring with the effort, too.
    /// It may be infinite.
    pub max_force: f32,
    /// Position at which the spring rests; `None` for that at the start, which is 0 or [`Joint::length`].
    pub target: Option<f32>,
    /// Stiffness of the spring, in mass/s², or in mass units²/s² per rad. Not negative.
    pub stiffness: f32,
    /// Damping of the spring, in mass/s, or in mass units²/s per rad. Not negative.
    pub damping: f32,
    /// A force in mass units/s² along the axis, or a torque in mass units²/s² about it, that acts on the second body. A controller
    /// may set it in every step.
    pub effort: f32,
    /// Damping that [`Joint::max_force`] does not bound, in mass/s, or in mass units²/s per rad. Not negative.
    pub drag: f32,
    /// Inertia of a rotor that turns with the joint, in mass units², or in mass for one that slides. Not negative. It resists
    /// changes of the speed, and has no weight.
    pub armature: f32,
    /// The greatest force or torque of friction. Not negative.
    pub friction: f32,
    /// The joint breaks at a greater mean force of a frame, in mass units/s². Infinite for a joint that does not break.
    pub break_force: f32,
    /// The joint breaks at a greater mean torque of a frame, in mass units²/s².
    pub break_torque: f32,
    /// Whether its bodies collide. Those of other joints pass through each other.
    pub collides: bool,
    /// For a distance joint: the distance at the start, in units. `None` before it was added, for that of its anchors. It keeps
    /// this distance unless it has limits, a motor, a spring, an effort, friction, drag or an armature.
    pub length: Option<f32>,
    pub(crate) laid: Laid,
}

impl Joint {
    fn new(kind: JointKind, a: Anchor, b: Anchor, at: DVec3) -> Self {
        Self {
            kind,
            a,
            b,
            name: None,
            limits: None,
            cone: None,
            speed: None,
            max_force: f32::INFINITY,
            target: None,
            stiffness: 0.0,
            damping: 0.0,
            effort: 0.0,
            drag: 0.0,
            armature: 0.0,
            friction: 0.0,
            break_force: f32::INFINITY,
            break_torque: f32::INFINITY,
            collides: false,
            length: None,
            laid: Laid::World { at, to: at, axis: None },
        }
    }

    /// A joint about a point of the world, in units. The axis of its cone and its twist is that of x unless [`Joint::axis`]
    /// sets another one.
    pub fn ball(a: impl Into<Anchor>, b: impl Into<Anchor>, at: impl Into<DVec3>) -> Self {
        Self::new(JointKind::Ball, a.into(), b.into(), at.into())
    }

    /// A joint about an axis through a point of the world, in units.
    pub fn hinge(a: impl Into<Anchor>, b: impl Into<Anchor>, at: impl Into<DVec3>, axis: impl Into<DVec3>) -> Self {
        Self::new(JointKind::Hinge, a.into(), b.into(), at.into()).axis(axis)
    }

    /// A joint along an axis. Its force acts at a point of the world, in units.
    pub fn slider(a: impl Into<Anchor>, b: impl Into<Anchor>, at: impl Into<DVec3>, axis: impl Into<DVec3>) -> Self {
        Self::new(JointKind::Slider, a.into(), b.into(), at.into()).axis(axis)
    }

    /// A joint that keeps the places of two bodies. Its force acts at a point of the world, in units.
    pub fn fixed(a: impl Into<Anchor>, b: impl Into<Anchor>, at: impl Into<DVec3>) -> Self {
        Self::new(JointKind::Fixed, a.into(), b.into(), at.into())
    }

    /// A joint of a point of the first body and a point of the second one, both in the world, in units.
    pub fn distance(a: impl Into<Anchor>, b: impl Into<Anchor>, at: impl Into<DVec3>, to: impl Into<DVec3>) -> Self {
        let (at, to) = (at.into(), to.into());
        Self { laid: Laid::World { at, to, axis: None }, ..Self::new(JointKind::Distance, a.into(), b.into(), at) }
    }

    /// Sets the axis of a ball, hinge or slider, in the world. Its length does not matter, but it is not 0. Without effect after
    /// [`Joint::frames`].
    pub fn axis(mut self, direction: impl Into<DVec3>) -> Self {
        match &mut self.laid {
            Laid::World { axis, .. } => *axis = Some(direction.into()),
            Laid::Ends(_) => {}
        }
        self
    }

    /// Sets both ends in coordinates of their bodies, in place of points and an axis of the world.
    pub fn frames(mut self, ends: [JointFrame; 2]) -> Self {
        self.laid = Laid::Ends(ends);
        self
    }

    /// Sets the name.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Sets the least and the greatest position. Those of a joint whose ends are points of the world contain its position at the start.
    pub fn limits(mut self, least: f32, greatest: f32) -> Self {
        self.limits = Some([least, greatest]);
        self
    }

    /// Sets the greatest angle between the axes of both bodies of a ball, in rad.
    pub fn cone(mut self, angle: f32) -> Self {
        self.cone = Some(angle);
        self
    }

    /// Adds a motor of a speed in rad/s or units/s. [`Joint::max_force`] bounds it.
    pub fn motor(mut self, speed: f32) -> Self {
        self.speed = Some(speed);
        self
    }

    /// Sets the greatest force or torque of the motor, and of the spring with the effort.
    pub fn max_force(mut self, force: f32) -> Self {
        self.max_force = force;
        self
    }

    /// Adds a spring towards the target.
    pub fn spring(mut self, stiffness: f32, damping: f32) -> Self {
        (self.stiffness, self.damping) = (stiffness, damping);
        self
    }

    /// Sets the position at which the spring rests.
    pub fn target(mut self, position: f32) -> Self {
        self.target = Some(position);
        self
    }

    /// Sets the force along the axis, or the torque about it.
    pub fn effort(mut self, force: f32) -> Self {
        self.effort = force;
        self
    }

    /// Adds damping that [`Joint::max_force`] does not bound.
    pub fn drag(mut self, drag: f32) -> Self {
        self.drag = drag;
        self
    }

    /// Adds the inertia of a rotor that turns with the joint.
    pub fn armature(mut self, inertia: f32) -> Self {
        self.armature = inertia;
        self
    }

    /// Sets the greatest force or torque of friction.
    pub fn friction(mut self, force: f32) -> Self {
        self.friction = force;
        self
    }

    /// Lets the joint break at a greater mean force or torque of a frame.
    pub fn breaks_at(mut self, force: f32, torque: f32) -> Self {
        (self.break_force, self.break_torque) = (force, torque);
        self
    }

    /// Lets its bodies collide.
    pub fn colliding(mut self) -> Self {
        self.collides = true;
        self
    }

    /// Sets the distance at the start of a distance joint, in units.
    pub fn length(mut self, length: f32) -> Self {
        self.length = Some(length);
        self
    }

    /// Both ends in coordinates of their bodies; `None` for a joint that was not added to a scene and has points of the world.
    pub fn ends(&self) -> Option<[JointFrame; 2]> {
        match self.laid {
            Laid::World { .. } => None,
            Laid::Ends(ends) => Some(ends),
        }
    }

    /// The bodies of both ends.
    pub fn anchors(&self) -> [Anchor; 2] {
        [self.a, self.b]
    }

    /// Position at which the spring rests.
    pub fn rest(&self) -> f32 {
        self.target.or(self.length).unwrap_or(0.0)
    }

    /// Whether it has a spring.
    pub fn has_spring(&self) -> bool {
        self.stiffness > 0.0 || self.damping > 0.0
    }

    /// Whether it is a distance joint that keeps its length.
    pub fn is_locked(&self) -> bool {
        let is_driven = self.speed.is_some() || self.has_spring() || self.effort != 0.0;
        let is_slowed = [self.friction, self.drag, self.armature].iter().any(|number| *number > 0.0);
        self.kind == JointKind::Distance && self.limits.is_none() && !is_driven && !is_slowed
    }
}

#[cfg(test)]
#[path = "joint_tests.rs"]
mod tests;
