//! A camera that keeps a body where it is in the picture.

use std::rc::Rc;

use rockfall::glam::Vec3;
use rockfall::{Result, Scene, Simulation, SphereId};

use crate::camera::Camera;

/// Finds the sphere to follow in a scene; `None` if the scene has none.
pub type Find = Rc<dyn Fn(&Scene) -> Option<SphereId>>;

/// Moves a camera with a sphere.
pub struct Follow {
    find: Find,
    /// The sphere, and the [`Session::scene_version`](super::session::Session::scene_version) in which it was found.
    found: Option<(SphereId, u64)>,
    /// Where the sphere was in the last frame.
    place: Option<Vec3>,
}

impl Follow {
    /// Follows the sphere that is found in each scene.
    pub fn new(find: Find) -> Self {
        Self { find, found: None, place: None }
    }

    /// Moves the camera as far as the sphere has moved since the last frame. In another scene it looks at the sphere.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device failed.
    pub fn update(&mut self, simulation: &mut Simulation, version: u64, camera: &mut Camera) -> Result<()> {
        let scene = simulation.sync()?;
        let known = self.found.filter(|(sphere, at)| *at == version && scene.sphere(*sphere).is_ok());
        if known.is_none() {
            (self.found, self.place) = ((self.find)(scene).map(|sphere| (sphere, version)), None);
        }
        let place = self.found.and_then(|(sphere, _)| scene.sphere(sphere).ok()).map(|sphere| sphere.position);
        if let Some(place) = place.filter(|place| place.is_finite()) {
            let moved = place - self.place.replace(place).unwrap_or(camera.target);
            camera.eye += moved;
            camera.target += moved;
        }
        Ok(())
    }
}
