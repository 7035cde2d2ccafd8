//! The impulses that the collision phase of the CPU backend applies at contacts, and what they do to rigid bodies.

use glam::{Quat, Vec3};

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

/// The changes of a rigid body by the impulses of the collision phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyPush {
    pub(crate) body: u32,
    pub(crate) velocity: Vec3,
    pub(crate) angular_momentum: Vec3,
    /// By a lone collision, which acts before the present.
    pub(crate) moved: Option<BodyMove>,
}

/// Where a rigid body is because an impulse has acted on it before the present.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyMove {
    /// Displacement of its centre of mass.
    pub(crate) by: Vec3,
    pub(crate) orientation: Quat,
}
