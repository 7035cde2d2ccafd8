//! What a sphere's state changes by.

use glam::Vec3;

/// Rates of change of a moving sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates {
    /// Of its velocity, in units/s².
    pub(crate) acceleration: Vec3,
    /// Of its angular momentum, in mass units²/s².
    pub(crate) torque: Vec3,
}
