//! A body that is held with the pointer.

use rockfall::glam::Vec3;
use rockfall::{SphereId, TetherId};

/// A sphere that a tether connects to the pointer.
#[derive(Clone, Debug)]
pub struct Held {
    /// The sphere.
    pub sphere: SphereId,
    /// The tether that holds it.
    pub tether: TetherId,
    /// Position of the pointer in the scene, in units.
    pub pointer: Vec3,
    /// The moving spheres that rods and springs connect to it, with itself.
    pub(super) connected: Vec<SphereId>,
    /// Vector from the grabbed point to the centre of the sphere.
    pub(super) offset: Vec3,
    /// Distance of the grabbed point from the eye along `forward`.
    pub(super) depth: f32,
}

/// The line of sight through the pointer.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Position of the eye.
    pub origin: Vec3,
    /// Unit vector through the pointer.
    pub direction: Vec3,
    /// Unit vector of the viewing direction of the camera.
    pub forward: Vec3,
}

impl Sight {
    /// Returns the point at a distance from the eye along `forward`.
    pub fn at_depth(&self, depth: f32) -> Vec3 {
        let slope = self.direction.dot(self.forward).max(1e-3);
        self.origin + depth / slope * self.direction
    }
}
