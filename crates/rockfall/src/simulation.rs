//! The front door: a scene that moves.

use glam::Vec3;

use crate::error::Result;
use crate::model::layout::{FEW_MOVERS, SLICE};
use crate::model::status::Status;
use crate::model::world::World;
use crate::options::{BackendInfo, Options};
use crate::profile::Recorder;
use crate::report::Report;
use crate::scene::{Scene, SphereId};
use crate::settings::{BroadPhase, Integrator, Settings};
use crate::step::schedule::Phase;

mod drive;
mod edit;
mod engine;
mod flight;
mod interval;
mod keep;
mod lookahead;
mod observe;
mod order;
mod prepare;
mod profile;
mod ray;
mod read;
mod sweeps;

pub use drive::DEFAULT_TIME_STEP;
use drive::Window;
use edit::Dirty;
use engine::Engine;
use interval::Interval;
use lookahead::Lookahead;
pub use observe::{Body, Contact, ContactAction, SphereDiagnostics};
use order::Disorder;
pub use ray::RayHit;

/// Lists of few movers on a device are made for so many steps from the start, which others try first.
const FEW_STEPS: f32 = 4.0;

/// A scene and the machinery that moves it, on the GPU or on the CPU.
///
/// A step is four phases, each callable alone: [`update_aabbs`](Self::update_aabbs),
/// [`broad_phase`](Self::broad_phase), [`handle_collisions`](Self::handle_collisions) (switched off by
/// [`Settings::collisions`]) and [`update_positions`](Self::update_positions).
///
/// Objects are added, removed and changed between steps; such edits are collected and reach the device with the next
/// step or read. Nothing blocks on the device but the plain methods, each of which has an `_async` twin that does not.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    options: Options,
    info: BackendInfo,
    engine: Engine,
    /// What the engine runs on (CPU), or was filled from and is read back to (GPU).
    world: World,
    /// Spheres in the order in which they stand in `world`.
    packed: Vec<SphereId>,
    disorder: Disorder,
    /// How often the scene was packed or put in order.
    packings: u64,
    status: Status,
    report: Report,
    time_step: f32,
    /// How far ahead lists are made.
    lookahead: Lookahead,
    /// How often they may be made.
    interval: Interval,
    /// What came of these two.
    window: Window,
    /// What has to reach the engine before it may run.
    dirty: Dirty,
    edits: Vec<edit::Edits>,
    /// The AABBs do not fit the scene.
    aabbs_due: bool,
    /// The pair lists do not fit the scene.
    lists_due: bool,
    /// Stage states are those of a step of RK4 of the spheres as they are: they tell how these accelerate.
    has_stages: bool,
    /// `scene` holds the present state.
    synced: bool,
    /// Steps since collisions shared bodies.
    calm_steps: u64,
    /// Steps since many did.
    few_steps: u64,
}

impl Simulation {
    /// A simulation on a hardware GPU where there is one, else on the CPU.
    ///
    /// # Errors
    /// When the scene is too large, or its settings are not valid.
    #[cfg(not(target_family = "wasm"))]
    pub fn new(scene: Scene) -> Result<Self> {
        Self::with_options(scene, Options::default())
    }

    /// A simulation with a backend, an integrator and a broad phase of one's own choice.
    ///
    /// # Errors
    /// As for [`Simulation::new`]; and [`Error::NoAdapter`](crate::Error::NoAdapter) when a GPU is asked for and there is none.
    #[cfg(not(target_family = "wasm"))]
    pub fn with_options(scene: Scene, options: Options) -> Result<Self> {
        engine::block_on(None, Self::with_options_async(scene, options))
    }

    /// [`Simulation::with_options`] without blocking.
    ///
    /// # Errors
    /// As there.
    pub async fn with_options_async(scene: Scene, options: Options) -> Result<Self> {
        let scene = resolve(scene)?;
        let world = prepare(&scene, &options)?;
        let (engine, info) = Engine::open(&options, &world).await?;
        Ok(Self::assemble(scene, options, world, engine, info))
    }

    /// A simulation on the caller's wgpu device, whose buffers [`Simulation::gpu_view`] gives.
    ///
    /// # Errors
    /// As for [`Simulation::new`], and [`Error::DeviceLimit`](crate::Error::DeviceLimit) for a scene that does not fit.
    #[cfg(feature = "gpu")]
    pub fn on_device(scene: Scene, options: Options, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        Self::on_device_as_is(resolve(scene)?, options, device, queue)
    }

    /// The same with constants that are resolved already.
    #[cfg(feature = "gpu")]
    fn on_device_as_is(scene: Scene, options: Options, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let world = prepare(&scene, &options)?;
        let (engine, info) = Engine::on_device(&options, device, queue, &world)?;
        Ok(Self::assemble(scene, options, world, engine, info))
    }

    fn assemble(scene: Scene, options: Options, mut world: World, engine: Engine, info: BackendInfo) -> Self {
        engine.complete(&mut world);
        let (mut lookahead, mut interval) = (Lookahead::default(), Interval::default());
        if engine.dispatches() && world.movers() <= FEW_MOVERS {
            lookahead = Lookahead::from_steps(FEW_STEPS);
            world.step.lookahead = FEW_STEPS;
            interval = Interval::long();
        }
        Self {
            packed: scene.sphere_ids().collect(),
            disorder: Disorder::default(),
            packings: 1,
            status: world.status,
            scene,
            options,
            info,
            engine,
            world,
            report: Report::default(),
            time_step: DEFAULT_TIME_STEP,
            lookahead,
            interval,
            window: Window::default(),
            dirty: Dirty::Clean,
            edits: Vec::new(),
            aabbs_due: true,
            lists_due: true,
            has_stages: false,
            synced: true,
            calm_steps: 0,
            few_steps: 0,
        }
    }

    /// The backend that moves the scene, and why it was chosen.
    pub fn backend(&self) -> &BackendInfo {
        &self.info
    }

    /// How positions and velocities are advanced.
    pub fn integrator(&self) -> Integrator {
        self.options.integrator
    }

    /// How pairs are found: what was asked for, or what suits the number of objects.
    pub fn broad_phase_method(&self) -> BroadPhase {
        self.options.broad_phase.resolve(self.world.objects() as usize)
    }

    /// The physical constants; with [`Settings::resting_overlap`] those that were chosen for it.
    pub fn settings(&self) -> &Settings {
        &self.scene.settings
    }

    /// Changes the physical constants, from the next step on. Where [`Settings::resting_overlap`] is positive and it, gravity or
    /// the constants of contacts are changed, contact force and damping are chosen anew, from the positions that were
    /// read back last. Nothing else chooses them anew: they stay as they are while bodies move, are added and removed, and in a
    /// simulation that is resumed.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) when a value is not allowed; nothing is changed then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.validate()?;
        let decides = |s: &Settings| (s.resting_overlap, s.gravity, s.gravity_direction, s.contact_force, s.contact_damping);
        let same = decides(&settings) == decides(&self.scene.settings);
        self.scene.settings = settings;
        if !same {
            self.scene.settings = self.scene.resolved_settings();
        }
        self.world.set_settings(&self.scene.settings);
        Ok(())
    }

    /// What happened up to now.
    pub fn report(&self) -> Report {
        self.report
    }

    /// The time step of the last `step`, `run` or `update_positions`, in s; AABBs are grown for it.
    pub fn time_step(&self) -> f32 {
        self.time_step
    }

    /// One step of `dt` seconds: AABBs, broad phase, collisions unless they are switched off, forces and integration.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a time step that is not positive and finite,
    /// [`Error::NonFinite`](crate::Error::NonFinite) when a body's state stopped being finite in it (unless told to go on),
    /// [`Error::Device`](crate::Error::Device) when the GPU failed.
    #[cfg(not(target_family = "wasm"))]
    pub fn step(&mut self, dt: f32) -> Result<Report> {
        self.run(1, dt)
    }

    /// Many steps of `dt` seconds, submitted together where the backend can.
    ///
    /// # Errors
    /// As for [`Simulation::step`]; the steps before the failing one are done.
    #[cfg(not(target_family = "wasm"))]
    pub fn run(&mut self, steps: u64, dt: f32) -> Result<Report> {
        let device = self.engine.waiter();
        engine::block_on(device, self.run_async(steps, dt))
    }

    /// [`Simulation::run`] without blocking.
    ///
    /// # Errors
    /// As there.
    pub async fn run_async(&mut self, steps: u64, dt: f32) -> Result<Report> {
        self.run_recorded(steps, dt, None).await?;
        Ok(self.report)
    }

    async fn run_recorded(&mut self, steps: u64, dt: f32, recorder: Option<&mut Recorder>) -> Result<()> {
        self.set_time_step(dt)?;
        self.drive(self.step_phases(), steps, recorder).await
    }

    /// The phases of a whole step, in the order in which it runs them.
    fn step_phases(&self) -> &'static [Phase] {
        let has_phase = self.scene.settings.collisions || self.scene.settings.has_friction_impulses();
        if has_phase { &drive::COLLISIONS_FIRST } else { &drive::WITHOUT_COLLISIONS }
    }

    /// Phase 1 alone: the AABBs of all objects, grown for the present time step.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn update_aabbs(&mut self) -> Result<()> {
        self.phase(Phase::UpdateAabbs)
    }

    /// Phase 2 alone: the pair lists, from the AABBs as they are.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn broad_phase(&mut self) -> Result<()> {
        self.phase(Phase::BroadPhase)
    }

    /// Phase 3 alone: collisions, whether or not they are switched on. Uses the last pair lists; where these are due
    /// (objects were added, removed or moved by hand, or moved out of their AABBs) they are made first.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn handle_collisions(&mut self) -> Result<()> {
        self.phase(Phase::HandleCollisions)
    }

    /// Phase 4 alone: forces, integration and constraints; a step is counted. Uses the last pair lists as
    /// [`Simulation::handle_collisions`] does.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn update_positions(&mut self, dt: f32) -> Result<()> {
        self.set_time_step(dt)?;
        self.phase(Phase::UpdatePositions)
    }

    #[cfg(not(target_family = "wasm"))]
    fn phase(&mut self, phase: Phase) -> Result<()> {
        let device = self.engine.waiter();
        engine::block_on(device, self.phase_async(phase))
    }

    /// One phase alone, without blocking; [`Phase::UpdatePositions`] takes the present [`time_step`](Self::time_step).
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    pub async fn phase_async(&mut self, phase: Phase) -> Result<()> {
        self.drive(&[phase], 1, None).await
    }

    /// Gravity's acceleration as the step sees it, in units/s².
    pub fn gravity(&self) -> Vec3 {
        Vec3::from_array(self.world.step.gravity)
    }
}

/// A scene with the constants that its own choose.
fn resolve(mut scene: Scene) -> Result<Scene> {
    scene.settings.validate()?;
    scene.settings = scene.resolved_settings();
    Ok(scene)
}

/// The world of a scene, with what the options say of it and without scratch.
fn prepare(scene: &Scene, options: &Options) -> Result<World> {
    scene.settings.validate()?;
    let mut world = World::for_method(scene, options.broad_phase)?;
    if let Some(capacity) = options.pair_capacity {
        world.set_pair_room(capacity.div_ceil(SLICE));
    }
    if options.keep_going {
        world.step.flags |= crate::model::layout::FLAG_CONTINUE;
    }
    Ok(world)
}
