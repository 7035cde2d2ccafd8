//! A body that is held with the pointer.

use rockfall::glam::Vec3;
use rockfall::{Grip, SphereId, TetherId};

/// A body that the pointer holds.
#[derive(Clone, Debug)]
pub struct Held {
    /// The sphere that is held, or a sphere of the body.
    pub sphere: SphereId,
    /// Position of the pointer in the scene, in units.
    pub pointer: Vec3,
    /// What holds it.
    pub(super) by: Hold,
    /// Distance of the grabbed point from the eye along `forward`.
    pub(super) depth: f32,
}

/// What holds a body.
#[derive(Clone, Debug)]
pub(super) enum Hold {
    /// A tether to the centre of the sphere.
    Tether {
        tether: TetherId,
        /// The moving spheres that rods and springs connect to the sphere, with itself.
        connected: Vec<SphereId>,
        /// Vector from the grabbed point to the centre of the sphere.
        offset: Vec3,
    },
    /// A pull at the grabbed point, under the contact law `rigid`.
    Grip(Grip),
}

impl Held {
    /// The tether that holds the body, if it is one.
    pub(super) fn tether(&self) -> Option<TetherId> {
        match self.by {
            Hold::Tether { tether, .. } => Some(tether),
            Hold::Grip(_) => None,
        }
    }
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
