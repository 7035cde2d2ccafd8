//! rockfall: a rigid-body physics engine that lives on the GPU.
//!
//! Spheres, rods, capsules, springs, static boxes and polygons, from a handful to millions, on any GPU that speaks Vulkan,
//! Metal, DX12 or WebGPU, and on the CPU where there is none.
//!
//! ```
//! use rockfall::{Cuboid, Scene, Simulation, Sphere};
//!
//! # fn main() -> rockfall::Result<()> {
//! let mut scene = Scene::new();
//! scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]))?;
//! let ball = scene.add_sphere(Sphere::new([0.0, 2.0, 0.0], 0.5).mass(2.0))?;
//! let mut simulation = Simulation::new(scene)?;
//! simulation.run(1_000, 0.02)?;
//! let height = simulation.sphere(ball)?.position.y;
//! assert!((height - 0.499).abs() < 1e-3, "it rests 0.5 above the floor, less its weight's overlap");
//! # Ok(())
//! # }
//! ```
//!
//! A [`Scene`] holds objects and [`Settings`]; a [`Simulation`] moves it. Objects are plain builders with units on every
//! field, handles are typed and outlive the removal of others, and every fallible call returns the one [`Error`].
//!
//! # The thesis's interface
//! The engine comes from Csefalvay, *Dynamic simulation of rigid bodies using programmable GPUs*. Its functions (section
//! 2.10) are found here:
//!
//! | thesis | rockfall |
//! |---|---|
//! | `addSphere` | [`Scene::add_sphere`], [`Simulation::add_sphere`] with a [`Sphere`] |
//! | `addRod` | [`Scene::add_rod`], [`Simulation::add_rod`] with a [`Rod`] |
//! | `addPolygon` | [`Scene::add_polygon`], [`Simulation::add_polygon`] with a [`Polygon`] |
//! | `addCapsule` | [`Scene::add_capsule`], [`Simulation::add_capsule`] with a [`Capsule`] |
//! | `addBox` | [`Scene::add_box`], [`Simulation::add_box`] with a [`Cuboid`] |
//! | `addSpring` | [`Scene::add_spring`], [`Simulation::add_spring`] with a [`Spring`] |
//! | `updateObjectsInHostMemory` | [`Simulation::sync`], [`Simulation::spheres`], [`Simulation::sphere`] |
//! | `updateDebugVarsInHostMemory` | [`Simulation::diagnostics`], [`Simulation::contacts`], [`Simulation::energy`] |
//! | `updateAABBs` | [`Simulation::update_aabbs`] |
//! | `broadPhaseCD` | [`Simulation::broad_phase`] |
//! | `handleCollisions` | [`Simulation::handle_collisions`] |
//! | `updatePositions(time step)` | [`Simulation::update_positions`] |
//! | all four | [`Simulation::step`], [`Simulation::run`] |
//! | scene file (2.11) | [`Scene::load`], [`Scene::parse`], [`Scene::save`], [`Scene::to_text`] |
//! | constants (2.8) | [`Settings`], [`Simulation::set_settings`] |
//!
//! # What to know of the model
//! Contacts are soft: a body rests with an overlap of about m G / (Cc m\*), m\* the reduced mass of the contact. Friction is
//! proportional to the overlap and to the square root of the sliding velocity; with the default constants it is 0.05 sqrt(|t|)
//! times the elastic normal force, so bodies creep on slopes; with [`Settings::coulomb_friction`] there is Coulomb friction in its place. The time step must
//! suit springs, contacts and speeds ([`Scene::stability`], [`Scene::tunnelling`]), the contact force the radii
//! ([`Scene::sinking`], [`Settings::resting_overlap`]).
//! `docs/physics.md` in the repository specifies the model in full: its sections and errata are what comments cite.
//!
//! # Features
//! `gpu` (default): the wgpu backend. Without it only the CPU backend is built, and it needs no graphics library.

pub mod checkpoint;
mod devices;
pub mod error;
#[doc(hidden)]
pub mod exec;
pub mod generate;
#[doc(hidden)]
pub mod model;
mod options;
pub mod output;
mod physics;
pub mod profile;
pub mod report;
pub mod scene;
pub mod settings;
pub mod simulation;
pub mod stability;
#[doc(hidden)]
pub mod step;
mod traffic;

pub use checkpoint::Checkpoint;
pub use devices::{DeviceInfo, devices};
pub use error::{Error, Result};
#[cfg(feature = "gpu")]
pub use exec::gpu;
pub use glam;
pub use options::{Backend, BackendInfo, Options};
pub use profile::{BufferSize, Clock, Profile, StageTime};
pub use report::{Energy, Report, SphereState};
pub use scene::{
    BoxId, Capsule, CapsuleId, CapsuleParts, Counts, Cuboid, LineWarning, Loaded, Polygon, PolygonId, Rod, RodId, Scene,
    Sphere, SphereId, Spring, SpringId, Tether, TetherId,
};
pub use settings::{BroadPhase, Integrator, Settings};
pub use simulation::{Body, Contact, ContactAction, RayHit, Simulation, SphereDiagnostics};
#[cfg(feature = "gpu")]
pub use wgpu;

/// The README's example is a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
