//! What the springs of a contact add to its description.

use glam::Vec3;

use crate::simulation::{Contact, ContactAction};

/// The springs of a contact of a law with history (docs/physics sections 4.11 and 4.12), as they are when the contact exerts its
/// force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactSprings {
    /// Tangential displacement of A's surface relative to B's that the contact remembers, in units.
    pub displacement: Vec3,
    /// Torque of the springs against rolling and twisting on B, in mass units²/s². A receives the opposite.
    pub moment: Vec3,
    /// Whether the tangential force is at Coulomb's limit, so that the surfaces slip. Otherwise they stick.
    pub slips: bool,
}

impl Contact {
    /// Contact force on B along the normal, in mass units/s²: positive where the contact pushes the bodies apart. 0 in a
    /// collision.
    pub fn normal_force(&self) -> f32 {
        match self.action {
            ContactAction::Force(force) => force.dot(self.normal),
            ContactAction::Impulse(_) => 0.0,
        }
    }

    /// Contact force on B across the normal, in mass units/s². 0 in a collision.
    pub fn tangential_force(&self) -> Vec3 {
        match self.action {
            ContactAction::Force(force) => force - force.dot(self.normal) * self.normal,
            ContactAction::Impulse(_) => Vec3::ZERO,
        }
    }
}
