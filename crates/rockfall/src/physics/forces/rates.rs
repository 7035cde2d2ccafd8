//! The rates of change of a sphere's state.

use glam::Vec3;

/// Rates of change of a moving sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates {
    /// Rate of change of the velocity, in units/s².
    pub(crate) acceleration: Vec3,
    /// Rate of change of the angular momentum, in mass units²/s².
    pub(crate) torque: Vec3,
}
