//! The impulses that the collision phase of the CPU backend applies at contacts.

use glam::Vec3;

/// Insertion indices of A and B, and the feature.
pub(crate) type Key = (u32, u32, u32);

/// The impulse of a contact in the collision phase. B gets this impulse, A gets the opposite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    pub(crate) key: Key,
    /// Magnitude, in units of mass times velocity.
    pub(crate) size: f32,
    /// Unit vector.
    pub(crate) direction: Vec3,
}
