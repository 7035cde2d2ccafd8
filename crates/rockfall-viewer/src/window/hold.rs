//! A body that is held by a tether, and the line of sight that holds it.

use rockfall::glam::Vec3;
use rockfall::{SphereId, TetherId};

/// A sphere that is tied to the pointer.
#[derive(Clone, Debug)]
pub struct Held {
    /// The sphere.
    pub sphere: SphereId,
    /// What holds it.
    pub tether: TetherId,
    /// Where the pointer is in space.
    pub pointer: Vec3,
    /// From the point where it was seized to its centre.
    pub(super) offset: Vec3,
    /// How far in front of the eye it is held, along `forward`.
    pub(super) depth: f32,
}

/// A line of sight through the pointer.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// The eye.
    pub origin: Vec3,
    /// Unit vector through the pointer.
    pub direction: Vec3,
    /// Unit vector that the camera looks along.
    pub forward: Vec3,
}

impl Sight {
    pub(super) fn at_depth(&self, depth: f32) -> Vec3 {
        let slope = self.direction.dot(self.forward).max(1e-3);
        self.origin + depth / slope * self.direction
    }
}
