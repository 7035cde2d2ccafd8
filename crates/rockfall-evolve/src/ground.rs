//! What creatures walk on.

use rockfall::glam::DVec3;
use rockfall::{Cuboid, Result, Scene};

use crate::surface::Surface;

/// Half the side of the level ground: for any creature in units, and for its way in units/s.
const EXTENT: [f64; 2] = [50.0, 5.0];

/// The statics and constants of a world without its creature.
#[derive(Clone, Debug)]
pub struct Ground {
    scene: Scene,
    surface: Surface,
}

impl Ground {
    /// Level ground at height 0 with Earth's gravity. Feet stick by the friction of the thesis (docs/physics section 4.5): about
    /// 0.6 times the normal force at 0.1 units/s. There are no impulses, so that small creatures run on a GPU side by side
    /// ([`WorldPath::Device`](rockfall::WorldPath::Device)).
    ///
    /// It is so large that creatures do not reach its edge in `seconds`.
    ///
    /// # Errors
    /// [`Error::Invalid`](rockfall::Error::Invalid) for a time that is not finite.
    pub fn level(seconds: f64) -> Result<Self> {
        let mut scene = Scene::new();
        scene.settings.set("gravity", "9.81")?;
        scene.settings.set("collisions", "off")?;
        scene.settings.set("contact_force", "8000")?;
        scene.settings.set("contact_damping", "60")?;
        scene.settings.set("friction", "16000")?;
        let extent = (EXTENT[0] + EXTENT[1] * seconds) as f32;
        scene.add_box(Cuboid::between([-extent, -1.0, -extent], [extent, 0.0, extent]))?;
        Ok(Self::of(scene))
    }

    /// The statics and constants of a scene. Creatures start with their lowest point at height 0 above its origin.
    pub fn of(scene: Scene) -> Self {
        Self { surface: Surface::of(&scene), scene }
    }

    /// Distance that a ball can fall straight down until it touches something, in units: 0 if it touches something already,
    /// infinity if there is nothing below it.
    pub(crate) fn fall(&self, centre: DVec3, radius: f64) -> f64 {
        self.surface.fall(centre, radius)
    }

    /// A world without a creature.
    pub fn scene(&self) -> Scene {
        self.scene.clone()
    }
}
