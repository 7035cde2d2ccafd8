//! rockfall: a rigid-body physics engine that lives on the GPU.

pub mod error;
pub mod layout;
pub mod output;
pub mod scene;
pub mod settings;
pub mod stability;
pub mod stage;
pub mod world;

pub use error::{Error, Result};
pub use glam;
pub use scene::{
    BoxId, Capsule, CapsuleId, CapsuleParts, Counts, Cuboid, LineWarning, Loaded, Polygon, PolygonId, Rod, RodId, Scene,
    Sphere, SphereId, Spring, SpringId, Tether, TetherId,
};
pub use settings::{Integrator, Settings};
