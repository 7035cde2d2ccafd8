//! What creatures walk on.

use rockfall::{Cuboid, Result, Scene};

/// Half the side of the level ground, in units.
const EXTENT: f32 = 500.0;

/// The statics and constants of a world without its creature.
#[derive(Clone, Debug)]
pub struct Ground {
    scene: Scene,
}

impl Ground {
    /// Level ground at height 0 with Earth's gravity. Feet stick by the friction of the thesis (docs/physics.md section 4.5): about
    /// 0.6 times the normal force at 0.1 units/s. There are no impulses, so that small creatures run on a GPU side by side
    /// ([`WorldPath::Device`](rockfall::WorldPath::Device)).
    ///
    /// # Errors
    /// None for these constants.
    pub fn level() -> Result<Self> {
        let mut scene = Scene::new();
        scene.settings.set("gravity", "9.81")?;
        scene.settings.set("collisions", "off")?;
        scene.settings.set("contact_force", "8000")?;
        scene.settings.set("contact_damping", "60")?;
        scene.settings.set("friction", "16000")?;
        scene.add_box(Cuboid::between([-EXTENT, -10.0, -EXTENT], [EXTENT, 0.0, EXTENT]))?;
        Ok(Self { scene })
    }

    /// The statics and constants of a scene. Creatures start with their lowest point at height 0 above its origin.
    pub fn of(scene: Scene) -> Self {
        Self { scene }
    }

    /// A world without a creature.
    pub fn scene(&self) -> Scene {
        self.scene.clone()
    }
}
