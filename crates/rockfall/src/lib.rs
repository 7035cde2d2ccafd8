//! A rigid-body physics engine that runs on the GPU.
//!
//! rockfall simulates spheres, rods, capsules, springs, tethers, static boxes and static polygons, from a handful to millions.
//! It runs on any GPU with Vulkan, Metal, DX12 or WebGPU, and on the CPU if there is none.
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
//! assert!((height - 0.499).abs() < 1e-3, "it rests 0.5 above the floor, less the overlap caused by its weight");
//! # Ok(())
//! # }
//! ```
//!
//! # Overview
//! - A [`Scene`] holds objects and [`Settings`]. It can be loaded from a text file, saved, and generated ([`generate`]).
//! - A [`Simulation`] advances a scene in time, with [`Options`] that choose the backend, the integrator and the broad phase.
//!   Objects can be added, removed and changed between steps.
//! - [`Simulation::spheres`] and [`Simulation::sphere`] read states back. [`Simulation::energy`], [`Simulation::contacts`],
//!   [`Simulation::max_overlap`] and [`Simulation::diagnostics`] evaluate them. [`Report`] counts steps, contacts and collisions.
//! - A [`ForceLaw`] is a force on bodies that the program defines, a [`ContactForceLaw`] a law of contacts.
//! - A [`Checkpoint`] stores a simulation, so that it can be resumed with bitwise identical results.
//! - [`Scene::stability`], [`Scene::tunnelling`] and [`Scene::sinking`] warn about an unsuitable time step or contact force.
//!   [`Scene::odd_rods`] finds rods that are likely mistakes.
//! - [`Simulation::profile`] measures the time of every stage.
//!
//! Objects are plain builders. Lengths and masses are in arbitrary units, times in seconds; every field states its unit.
//! Handles are typed, and stay valid when other objects are removed. Every fallible call returns an [`Error`].
//!
//! # The interface of the thesis
//! The engine is based on Csefalvay, *Dynamic simulation of rigid bodies using programmable GPUs*. The functions of the thesis
//! (section 2.10) correspond to these:
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
//! | all four phases | [`Simulation::step`], [`Simulation::run`] |
//! | scene file (2.11) | [`Scene::load`], [`Scene::parse`], [`Scene::save`], [`Scene::to_text`] |
//! | constants (2.8) | [`Settings`], [`Simulation::set_settings`] |
//!
//! # The model
//! Contacts are soft: a body at rest overlaps what it lies on by about m G / (Cc m\*), where m\* is the reduced mass of the
//! contact. Friction is proportional to the overlap and to the square root of the sliding velocity. With the default constants
//! it is 0.05 sqrt(|t|) times the elastic normal force, so bodies creep on slopes. [`Settings::coulomb_friction`] replaces it by
//! Coulomb friction.
//!
//! The time step must suit the springs, contacts and speeds of the scene ([`Scene::stability`], [`Scene::tunnelling`]). The
//! contact force must suit the radii ([`Scene::sinking`], [`Settings::resting_overlap`]).
//!
//! `docs/physics` in the repository specifies the model in full. Comments in the code cite its sections and errata.
//!
//! # Features
//! - `gpu` (default): the wgpu backend, and `wgsl`. Without this feature only the CPU backend is built, which needs no graphics
//!   library.
//! - `mpi`: one scene for several processes, by MPI, which must be installed (`docs/cluster.md`).
//! - `wgsl`: laws as WGSL text ([`ForceLaw::wgsl`]), also on the CPU backend. Not in a browser.

pub mod checkpoint;
#[cfg(any(test, feature = "mpi"))]
pub mod cluster;
mod devices;
mod disjoint;
mod eigen;
pub mod error;
#[doc(hidden)]
pub mod exec;
mod fine;
pub mod generate;
mod laws;
mod mesh;
#[doc(hidden)]
pub mod model;
mod options;
pub mod output;
mod phase;
mod physics;
pub mod placement;
pub mod profile;
pub mod report;
mod rigid;
mod rotate;
pub mod scene;
pub mod settings;
pub mod simulation;
pub mod stability;
#[doc(hidden)]
pub mod step;
mod user_laws;
#[cfg(not(target_family = "wasm"))]
mod worlds;

pub use checkpoint::Checkpoint;
pub use devices::{DeviceInfo, devices};
pub use error::{Error, Result};
#[cfg(feature = "gpu")]
pub use exec::gpu;
pub use glam;
pub use mesh::{Mesh, MeshFormat};
pub use options::{Backend, BackendInfo, Optimization, Options};
pub use profile::{BufferSize, Clock, Profile, StageTime};
pub use report::{Energy, Passage, Report, SphereState, decimal_time, short_number};
pub use scene::{
    Anchor, Body, BoxId, Capsule, CapsuleId, CapsuleParts, CohesionModel, Colour, ConeAxis, Counts, Cuboid, Facets, Gauge,
    Gauged, GrainKind, GrainMass, Inlet, Joint, JointFrame, JointId, JointKind, LineWarning, Loaded, Look, MassProperties,
    Material, MaterialId, Motion, MotionId, MotionTerm, Muscle, ObjectId, Outlet, Pair, Placement, Polygon, PolygonId, Radii,
    Rate, RigidBody, RigidBodyId, Rod, RodId, RollingModel, RunDefaults, Scene, Sensor, Servo, Shape, ShapeBox, ShapeHull,
    ShapeId, ShapeMass, ShapeRod, ShapeSphere, Shear, SizedBy, Sought, Sphere, SphereId, Spring, SpringId, Surface, Tag,
    Tether, TetherId,
};
pub use settings::{BroadPhase, ContactLaw, Integrator, IntegratorChoice, Precision, Settings};
pub use simulation::{
    Contact, ContactAction, ContactChange, ContactEvent, ContactSprings, Flow, GaugeReading, Grip, HardContacts, Inflow,
    JointReading, Link, MaxOverlap, Meter, MotionState, Outflow, Party, RayHit, SensorChange, SensorEvent, Simulation,
    SphereDiagnostics, Tension, WallLoad,
};
pub use user_laws::{ContactForceLaw, ContactInput, ContactResponse, ForceInput, ForceLaw, ForceLoad, Impact, PairParameter};
#[cfg(feature = "gpu")]
pub use wgpu;
#[cfg(not(target_family = "wasm"))]
pub use worlds::{Sample, Sleep, WorldPath, WorldReport, Worlds};
