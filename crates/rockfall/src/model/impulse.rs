//! What the collision phase of the CPU backend did to a contact.

use glam::Vec3;

/// Both objects by their order of addition, and the feature.
pub(crate) type Key = (u32, u32, u32);

/// What the collision phase gave a contact: B gets it, A the opposite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impulse {
    pub(crate) key: Key,
    /// Magnitude in mass units/s.
    pub(crate) size: f32,
    /// Unit vector.
    pub(crate) direction: Vec3,
}
