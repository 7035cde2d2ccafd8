//! Poses of frames.

use glam::{Quat, Vec3};

use crate::rotate::product;

/// Where the origin of a frame lies, and how its axes are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    /// Origin, in units.
    pub(crate) position: Vec3,
    /// Turns coordinates of the frame into those of the outer one. A unit quaternion.
    pub(crate) turn: Quat,
}

impl Pose {
    pub(crate) const IDENTITY: Self = Self { position: Vec3::ZERO, turn: Quat::IDENTITY };

    pub(crate) fn new(position: Vec3, turn: Quat) -> Self {
        Self { position, turn }
    }

    /// A point of the frame in outer coordinates.
    pub(crate) fn point(&self, inner: Vec3) -> Vec3 {
        self.position + self.turn * inner
    }

    /// An outer point in coordinates of the frame.
    pub(crate) fn inner(&self, point: Vec3) -> Vec3 {
        self.turn.inverse() * (point - self.position)
    }

    /// A frame that is given in this one, in outer coordinates.
    pub(crate) fn compose(&self, inner: &Pose) -> Self {
        Self { position: self.point(inner.position), turn: product(self.turn, inner.turn) }
    }

    /// Another frame in coordinates of this one.
    pub(crate) fn relative(&self, other: &Pose) -> Self {
        let back = self.turn.inverse();
        Self { position: back * (other.position - self.position), turn: product(back, other.turn) }
    }
}
