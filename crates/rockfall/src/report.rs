//! What a simulation tells of its steps.

use glam::{DVec3, Mat3, Quat, Vec3};

use crate::scene::Sphere;

/// What happened up to now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Steps done.
    pub steps: u64,
    /// Time simulated, in s.
    pub time: f64,
    /// Contacts (overlapping pairs) of the last step's first force evaluation.
    pub contacts: u32,
    /// Deepest overlap of the last step's first force evaluation, in units.
    pub max_overlap: f32,
    /// Collisions handled in the last step.
    pub collisions: u32,
    /// Collisions handled in all steps.
    pub total_collisions: u64,
    /// Steps that were run again, because a list had to grow or a body left its AABB.
    pub replays: u64,
    /// Steps in which AABBs and pair lists were made anew; in the others those of an earlier step still held every pair.
    pub list_builds: u64,
    /// How often a body was stopped because its state was no longer finite.
    pub non_finite: u64,
}

/// Energies and momenta of the present state; fixed spheres are left out of all sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Kinetic energy, rotation included.
    pub kinetic: f64,
    /// Potential energy in gravity, - sum m G g.x.
    pub potential: f64,
    /// Elastic energy of springs and tethers, sum k (d - l)² / 2.
    pub spring: f64,
    /// Elastic energy of contacts, sum Cc m* o² / 2.
    pub contact: f64,
    /// Momentum.
    pub momentum: DVec3,
    /// Angular momentum about the origin, with spin.
    pub angular_momentum: DVec3,
}

impl Energy {
    /// All energies together.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential + self.spring + self.contact
    }
}

/// A sphere as it is now.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SphereState {
    /// Centre, in units.
    pub position: Vec3,
    /// Velocity, in units/s.
    pub velocity: Vec3,
    /// Orientation, a unit quaternion.
    pub orientation: Quat,
    /// Angular momentum, in mass units²/s.
    pub angular_momentum: Vec3,
    /// Radius, in units.
    pub radius: f32,
    /// Mass.
    pub mass: f32,
    /// Whether it is fixed.
    pub fixed: bool,
}

impl SphereState {
    /// Orientation as a rotation matrix; its columns are the sphere's own axes.
    pub fn rotation(&self) -> Mat3 {
        Mat3::from_quat(self.orientation)
    }

    /// Angular velocity L / I, in rad/s.
    pub fn spin(&self) -> Vec3 {
        self.angular_momentum / (0.4 * self.mass * self.radius * self.radius)
    }
}

impl From<&Sphere> for SphereState {
    fn from(sphere: &Sphere) -> Self {
        Self {
            position: sphere.position,
            velocity: sphere.velocity,
            orientation: sphere.orientation,
            angular_momentum: sphere.angular_momentum,
            radius: sphere.radius,
            mass: sphere.mass,
            fixed: sphere.fixed,
        }
    }
}
