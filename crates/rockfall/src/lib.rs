//! rockfall: a rigid-body physics engine that lives on the GPU.

pub mod cpu;
pub mod error;
pub mod layout;
pub mod output;
pub mod report;
pub mod scene;
pub mod settings;
pub mod simulation;
pub mod stability;
pub mod stage;
pub mod world;

pub use error::{Error, Result};
pub use glam;
pub use report::{Energy, Report, SphereState};
pub use scene::{
    BoxId, Capsule, CapsuleId, CapsuleParts, Counts, Cuboid, LineWarning, Loaded, Polygon, PolygonId, Rod, RodId, Scene,
    Sphere, SphereId, Spring, SpringId, Tether, TetherId,
};
pub use settings::{Integrator, Settings};
pub use simulation::{Backend, BackendInfo, Body, BroadPhase, Contact, ContactAction, Options, Simulation, SphereDiagnostics};
