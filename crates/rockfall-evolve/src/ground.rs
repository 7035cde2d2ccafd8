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
    /// Level ground at height 0 with Earth's gravity and Coulomb friction.
    ///
    /// # Errors
    /// None for these constants.
    pub fn level() -> Result<Self> {
        let mut scene = Scene::new();
        scene.settings.set("gravity", "9.81")?;
        scene.settings.set("coulomb_friction", "0.8")?;
        scene.settings.set("collision_friction", "0.8")?;
        scene.settings.set("restitution", "0.1")?;
        scene.settings.set("resting_overlap", "0.04")?;
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
