//! The report of a simulation, its energies, and the state of its spheres.

use glam::{DVec3, Mat3, Quat, Vec3};

use crate::scene::Sphere;

/// Counts and times of all steps so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Number of steps done.
    pub steps: u64,
    /// Time simulated, in s.
    pub time: f64,
    /// Number of contacts (overlapping pairs) at the first force evaluation of the last step.
    pub contacts: u32,
    /// Deepest overlap at the first force evaluation of the last step, in units.
    pub max_overlap: f32,
    /// Number of collisions handled in the last step.
    pub collisions: u32,
    /// Number of collisions handled in all steps.
    pub total_collisions: u64,
    /// Number of times that a step was repeated, because a list had to grow or a body left its AABB.
    pub replays: u64,
    /// Number of steps in which AABBs and pair lists were rebuilt. In the other steps those of an earlier step still held every
    /// pair.
    pub list_builds: u64,
    /// Number of times that a body was stopped because its state was no longer finite.
    pub non_finite: u64,
}

/// Energies in mass units²/s² and momenta of the current state. All sums leave out fixed spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// Kinetic energy, including rotation.
    pub kinetic: f64,
    /// Potential energy in gravity: -sum of m G g.x.
    pub potential: f64,
    /// Elastic energy of springs and tethers: sum of k (d - l)² / 2.
    pub spring: f64,
    /// Elastic energy of contacts: sum of Cc m* o² / 2.
    pub contact: f64,
    /// Momentum, in mass units/s.
    pub momentum: DVec3,
    /// Angular momentum about the origin, including spin, in mass units²/s.
    pub angular_momentum: DVec3,
}

impl Energy {
    /// Sum of all energies.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential + self.spring + self.contact
    }
}

/// The current state of a sphere.
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
    /// Whether the sphere is fixed.
    pub fixed: bool,
}

impl SphereState {
    /// Orientation as a rotation matrix. Its columns are the axes of the sphere's own frame.
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
