//! The movable objects of a scene, springs and tethers, as builders: `Sphere::new([0.0, 1.0, 0.0], 0.5).mass(2.0)`.
//!
//! Lengths are in arbitrary length units ("units"), masses in arbitrary mass units ("mass"), and times in seconds.

use std::f64::consts::{PI, TAU};

use glam::{Quat, Vec3};

use crate::error::{Error, Result};
use crate::fine::Fine;
use crate::scene::checks::{finite, invalid, not_negative, positive};
use crate::scene::materials::MaterialId;
use crate::scene::muscle::Muscle;
use crate::scene::registry::Handle;

/// Handle of a [`Sphere`].
pub type SphereId = Handle<Sphere>;
/// Handle of a [`Rod`].
pub type RodId = Handle<Rod>;
/// Handle of a [`Capsule`].
pub type CapsuleId = Handle<CapsuleParts>;
/// Handle of a [`Spring`].
pub type SpringId = Handle<Spring>;
/// Handle of a [`Tether`].
pub type TetherId = Handle<Tether>;

/// A solid ball, moving or fixed. Its moment of inertia is 2/5 m r².
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sphere {
    /// Centre, in units.
    pub position: Vec3,
    /// What is left of the centre beyond the digits of `position`, in units: [`Sphere::centre`] is their sum. Simulations use it with
    /// [`Precision::Double`](crate::settings::Precision).
    pub position_low: Vec3,
    /// Velocity in units/s. For a fixed sphere, the velocity of its surface.
    pub velocity: Vec3,
    /// Angular momentum in mass units²/s. For a fixed sphere, it gives its surface a spin.
    pub angular_momentum: Vec3,
    /// Orientation, a unit quaternion.
    pub orientation: Quat,
    /// Mass, greater than 0.
    pub mass: f32,
    /// Radius in units, greater than 0.
    pub radius: f32,
    /// Whether the sphere is fixed. A fixed sphere never moves.
    pub fixed: bool,
    /// External force in mass units/s². It acts until it is changed.
    pub force: Vec3,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
}

impl Sphere {
    /// Creates a sphere of mass 1 at rest, with its centre and radius in units.
    pub fn new(position: impl Into<Vec3>, radius: f32) -> Self {
        Self {
            position: position.into(),
            position_low: Vec3::ZERO,
            velocity: Vec3::ZERO,
            angular_momentum: Vec3::ZERO,
            orientation: Quat::IDENTITY,
            mass: 1.0,
            radius,
            fixed: false,
            force: Vec3::ZERO,
            group: 0,
            material: None,
        }
    }

    /// Moves the centre to a position with the digits of an `f64`, in units. Simulations use the digits beyond those of an `f32` with
    /// [`Precision::Double`](crate::settings::Precision).
    pub fn centred_at(mut self, centre: [f64; 3]) -> Self {
        self.set_centre(centre);
        self
    }

    /// The centre, in units: the sum of `position` and `position_low`.
    pub fn centre(&self) -> [f64; 3] {
        // A low part of 0 keeps the sign of -0.
        let sum = |axis: usize| match self.position_low[axis] {
            0.0 => f64::from(self.position[axis]),
            low => f64::from(self.position[axis]) + f64::from(low),
        };
        [0, 1, 2].map(sum)
    }

    pub(crate) fn set_centre(&mut self, centre: [f64; 3]) {
        let Fine { high, low } = Fine::at(centre);
        (self.position, self.position_low) = (high, low);
    }

    /// Sets the mass.
    pub fn mass(mut self, mass: f32) -> Self {
        self.mass = mass;
        self
    }

    /// Sets the mass from a density in mass/units³: density 4/3 pi r³.
    pub fn density(self, density: f32) -> Self {
        let radius = f64::from(self.radius);
        self.mass((f64::from(density) * 4.0 / 3.0 * PI * radius.powi(3)) as f32)
    }

    /// Sets the velocity, in units/s.
    pub fn velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the angular momentum, in mass units²/s.
    pub fn angular_momentum(mut self, angular_momentum: impl Into<Vec3>) -> Self {
        self.angular_momentum = angular_momentum.into();
        self
    }

    /// Sets the orientation.
    pub fn orientation(mut self, orientation: Quat) -> Self {
        self.orientation = orientation;
        self
    }

    /// Makes the sphere fixed.
    pub fn fixed(mut self) -> Self {
        self.fixed = true;
        self
    }

    /// Sets the external force, in mass units/s².
    pub fn force(mut self, force: impl Into<Vec3>) -> Self {
        self.force = force.into();
        self
    }

    /// Sets the group.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the material.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Moment of inertia 2/5 m r², in mass units².
    pub fn inertia(&self) -> f32 {
        0.4 * self.mass * self.radius * self.radius
    }

    /// Spin (angular velocity), in rad/s.
    pub fn spin(&self) -> Vec3 {
        self.angular_momentum / self.inertia()
    }

    /// Whether the inverses of mass and inertia, which the kernels use, are finite and positive in f32.
    fn has_usable_inertia(&self) -> bool {
        let usable = |number: f32| number.is_normal() && number > 0.0;
        usable(self.inertia()) && usable(1.0 / self.inertia()) && usable(1.0 / self.mass)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        finite("sphere.position", self.position)?;
        finite("sphere.position_low", self.position_low)?;
        finite("sphere.velocity", self.velocity)?;
        finite("sphere.angular_momentum", self.angular_momentum)?;
        finite("sphere.force", self.force)?;
        positive("sphere.mass", self.mass)?;
        positive("sphere.radius", self.radius)?;
        if !self.has_usable_inertia() {
            return Err(Error::Invalid {
                field: "sphere.mass and sphere.radius",
                value: format!("{} and {}", self.mass, self.radius),
                expected: "an inertia 2/5 m r² and inverses that are neither 0 nor infinite in f32",
            });
        }
        if !self.orientation.is_normalized() {
            let q = self.orientation;
            return Err(invalid("sphere.orientation", [q.w, q.x, q.y, q.z], "a unit quaternion w, x, y, z"));
        }
        Ok(())
    }
}

/// A cylinder without caps between two spheres. It has no mass of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rod {
    /// The sphere at end 1.
    pub end1: SphereId,
    /// The sphere at end 2.
    pub end2: SphereId,
    /// Radius in units, greater than 0.
    pub radius: f32,
    /// The length that the rod is held at, in units; `None` for a free length.
    pub length: Option<f32>,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
}

impl Rod {
    /// Creates a rod of free length. The radius is in units.
    pub fn new(end1: SphereId, end2: SphereId, radius: f32) -> Self {
        Self { end1, end2, radius, length: None, group: 0, material: None }
    }

    /// Holds the rod at a length, in units, greater than 0.
    pub fn length(mut self, length: f32) -> Self {
        self.length = Some(length);
        self
    }

    /// Sets the group.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the material.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    pub(crate) fn validate(&self) -> Result<()> {
        positive("rod.radius", self.radius)?;
        if let Some(length) = self.length {
            positive("rod.length", length)?;
        }
        if self.end1 == self.end2 {
            return Err(invalid("rod.end2", self.end2, "a sphere other than end 1"));
        }
        Ok(())
    }
}

/// A rigid body made of two spheres, each with half the mass, and a rod of fixed length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Capsule {
    /// Centre of the sphere at end 1, in units.
    pub end1: Vec3,
    /// Centre of the sphere at end 2, in units.
    pub end2: Vec3,
    /// Velocity of both ends, in units/s.
    pub velocity: Vec3,
    /// Mass of the whole capsule, greater than 0.
    pub mass: f32,
    /// Radius in units, greater than 0.
    pub radius: f32,
    /// Collision group. Objects of different groups never touch.
    pub group: u16,
    /// Material; `None` for an object to whose contacts the constants of the scene apply.
    pub material: Option<MaterialId>,
}

impl Capsule {
    /// Creates a capsule of mass 1 at rest. Ends and radius are in units.
    pub fn new(end1: impl Into<Vec3>, end2: impl Into<Vec3>, radius: f32) -> Self {
        Self { end1: end1.into(), end2: end2.into(), velocity: Vec3::ZERO, mass: 1.0, radius, group: 0, material: None }
    }

    /// Sets the mass.
    pub fn mass(mut self, mass: f32) -> Self {
        self.mass = mass;
        self
    }

    /// Sets the mass from a density in mass/units³: density times the volume of the whole capsule, pi r² (l + 4/3 r), where l is
    /// the distance of the ends.
    pub fn density(self, density: f32) -> Self {
        let (radius, length) = (f64::from(self.radius), self.end1.as_dvec3().distance(self.end2.as_dvec3()));
        self.mass((f64::from(density) * PI * radius * radius * (length + 4.0 / 3.0 * radius)) as f32)
    }

    /// Sets the velocity, in units/s.
    pub fn velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the group.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the material.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Returns the distance of the ends if the capsule is valid.
    pub(crate) fn validate(&self) -> Result<f32> {
        finite("capsule.end1", self.end1)?;
        finite("capsule.end2", self.end2)?;
        finite("capsule.velocity", self.velocity)?;
        positive("capsule.mass", self.mass)?;
        positive("capsule.radius", self.radius)?;
        if !Sphere::new(self.end1, self.radius).mass(0.5 * self.mass).has_usable_inertia() {
            return Err(Error::Invalid {
                field: "capsule.mass and capsule.radius",
                value: format!("{} and {}", self.mass, self.radius),
                expected: "an inertia 2/5 m r² of its ends and inverses that are neither 0 nor infinite in f32",
            });
        }
        let length = self.end1.distance(self.end2);
        if !(length.is_normal() && length > 0.0) {
            return Err(Error::Invalid {
                field: "capsule.end1 and capsule.end2",
                value: format!("{:?} and {:?}", self.end1.to_array(), self.end2.to_array()),
                expected: "two points at a distance that is neither 0 nor infinite in f32",
            });
        }
        Ok(length)
    }
}

/// The spheres and the rod that a [`Capsule`] consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CapsuleParts {
    /// The sphere at end 1.
    pub end1: SphereId,
    /// The sphere at end 2.
    pub end2: SphereId,
    /// The rod between them.
    pub rod: RodId,
}

/// A damped spring between two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spring {
    /// One sphere.
    pub a: SphereId,
    /// The other sphere.
    pub b: SphereId,
    /// Stiffness k in mass/s², not negative.
    pub stiffness: f32,
    /// Rest length l in units, not negative.
    pub length: f32,
    /// Damping c in mass/s, not negative.
    pub damping: f32,
    /// Makes the rest length oscillate; `None` for a constant rest length.
    pub muscle: Option<Muscle>,
}

impl Spring {
    /// Creates an undamped spring of `stiffness` in mass/s² and rest `length` in units.
    pub fn new(a: SphereId, b: SphereId, stiffness: f32, length: f32) -> Self {
        Self { a, b, stiffness, length, damping: 0.0, muscle: None }
    }

    /// Sets the damping, in mass/s.
    pub fn damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    /// Makes the spring a muscle.
    pub fn muscle(mut self, muscle: Muscle) -> Self {
        self.muscle = Some(muscle);
        self
    }

    /// The rest length at a phase of the muscle in turns, in units.
    pub(crate) fn length_at_phase(&self, turns: f64) -> f64 {
        let share = self.muscle.map_or(0.0, |muscle| f64::from(muscle.amplitude) * (TAU * turns).sin());
        f64::from(self.length) * (1.0 + share)
    }

    pub(crate) fn validate(&self) -> Result<()> {
        not_negative("spring.stiffness", self.stiffness)?;
        not_negative("spring.length", self.length)?;
        not_negative("spring.damping", self.damping)?;
        self.muscle.map_or(Ok(()), |muscle| muscle.validate())?;
        if self.a == self.b {
            return Err(invalid("spring.b", self.b, "a sphere other than a"));
        }
        Ok(())
    }
}

/// A damped spring between a sphere and a point in space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Tether {
    /// The sphere.
    pub sphere: SphereId,
    /// The fixed point, in units.
    pub point: Vec3,
    /// Stiffness k in mass/s², not negative.
    pub stiffness: f32,
    /// Rest length l in units, not negative.
    pub length: f32,
    /// Damping c in mass/s, not negative.
    pub damping: f32,
}

impl Tether {
    /// Creates an undamped tether of rest length 0, to a point in units, of `stiffness` in mass/s².
    pub fn new(sphere: SphereId, point: impl Into<Vec3>, stiffness: f32) -> Self {
        Self { sphere, point: point.into(), stiffness, length: 0.0, damping: 0.0 }
    }

    /// Sets the rest length, in units.
    pub fn length(mut self, length: f32) -> Self {
        self.length = length;
        self
    }

    /// Sets the damping, in mass/s.
    pub fn damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    pub(crate) fn validate(&self) -> Result<()> {
        finite("tether.point", self.point)?;
        not_negative("tether.stiffness", self.stiffness)?;
        not_negative("tether.length", self.length)?;
        not_negative("tether.damping", self.damping)
    }
}
