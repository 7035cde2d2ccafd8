//! The simulation: advances a scene in time.

use glam::Vec3;

use crate::error::{Error, Result};
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
use crate::exec::gpu::Gpu;
use crate::model::layout::{FEW_MOVERS, FLAG_CONTINUE, FLAG_DOUBLE, SLICE};
use crate::model::muscles::MuscleClock;
use crate::model::residue::has_residues;
use crate::model::status::Status;
use crate::model::world::World;
use crate::options::{Backend, BackendInfo, Optimization, Options};
use crate::profile::Recorder;
use crate::report::{Clock, Report};
use crate::scene::{AnyId, BodyHandles, FlowState, Scene, SphereId};
use crate::settings::{BroadPhase, ContactLaw, Integrator, Precision, Settings};
use crate::step::schedule::Phase;
use crate::step::walls::move_walls::place_walls;
use crate::user_laws::ContactForceLaw;
use crate::user_laws::set::UserLaws;

mod contact_law;
mod contact_springs;
mod drive;
mod edit;
mod engine;
mod events;
#[cfg(feature = "gpu")]
mod exchange;
mod flight;
mod flow;
mod force_laws;
pub(crate) mod frames;
mod gauge;
mod keep;
mod kept;
mod lists;
mod meter;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(crate) mod mirror;
mod motions;
pub(crate) mod observe;
pub(crate) mod observed;
mod order;
mod planes;
mod prepare;
mod profile;
mod rates;
mod ray;
mod read;
#[cfg(any(test, feature = "mpi"))]
pub(crate) mod share;
mod shear_work;
mod springs;
mod sweeps;
mod tensions;
#[cfg(not(target_family = "wasm"))]
mod watch;

pub use contact_springs::ContactSprings;
use edit::Dirty;
use engine::Engine;
use events::Watched;
pub use events::{ContactChange, ContactEvent, Party, SensorChange, SensorEvent};
use flight::Portioning;
pub use flow::{Flow, Inflow, Outflow};
use frames::Frames;
pub use frames::{Grip, HardContacts, JointReading};
pub use gauge::{GaugeReading, WallLoad};
#[cfg(feature = "gpu")]
use kept::Kept;
use lists::ListPolicy;
pub use meter::Meter;
pub use motions::MotionState;
pub use observe::{Contact, ContactAction, MaxOverlap, SphereDiagnostics};
use order::Disorder;
use planes::Planes;
pub use ray::RayHit;
pub use tensions::{Link, Tension};

/// Advances a scene in time, on the GPU or on the CPU.
///
/// A step consists of four phases, and each can be called alone: [`update_aabbs`](Self::update_aabbs),
/// [`broad_phase`](Self::broad_phase), [`handle_collisions`](Self::handle_collisions) and
/// [`update_positions`](Self::update_positions). [`Settings::collisions`] switches the third one on or off.
///
/// Objects can be added, removed and changed between steps. Edits are collected and reach the device with the next step or
/// read. Only the plain methods block on the device; each has an `_async` twin that does not.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    options: Options,
    info: BackendInfo,
    engine: Engine,
    /// The arrays that the engine runs on (CPU), or the host's copy of the arrays on the device (GPU).
    world: World,
    /// Handles of the spheres in insertion order, as they were when `world` was packed.
    packed: Vec<SphereId>,
    /// The same of the rigid bodies.
    packed_bodies: BodyHandles,
    /// Handles of all objects at that time, by number; empty with the law of the thesis.
    packed_ids: Vec<AnyId>,
    /// What passed the planes of gauges.
    planes: Planes,
    disorder: Disorder,
    /// Number of times that the scene was packed or its memory was sorted.
    packings: u64,
    status: Status,
    report: Report,
    clock: Clock,
    time_step: f32,
    muscle_clock: MuscleClock,
    lists: ListPolicy,
    portioning: Portioning,
    /// The part of the scene that must be uploaded before the engine may run.
    dirty: Dirty,
    edits: Vec<edit::Edits>,
    /// The AABBs do not match the scene.
    aabbs_due: bool,
    /// The pair lists do not match the scene.
    lists_due: bool,
    /// The copy of an earlier state that observations reuse; `None` after anything but states has changed.
    observation: Option<Box<World>>,
    /// `scene` holds the current state.
    synced: bool,
    /// `scene` holds the current external forces.
    forces_synced: bool,
    /// Steps since the last step in which collisions shared a body.
    calm_steps: u64,
    /// Steps since the last step in which many collisions shared a body.
    few_steps: u64,
    flow: FlowState,
    /// The bodies of the contact law `rigid`; `None` before the first frame, and with other laws.
    frames: Option<Box<Frames>>,
    /// `frames` does not match the scene.
    frames_due: bool,
    /// Drives of joints have changed since the last step.
    drives_due: bool,
    /// External forces of bodies have changed since the last step.
    loads_due: bool,
    /// The point that the program pulls, and where to.
    pulls: Option<(Grip, Vec3)>,
    /// Events that are noted after every step.
    watched: Watched,
}

impl Simulation {
    /// Creates a simulation on the backend that [`Backend::Auto`] chooses.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a setting is not allowed, and an error when the scene is too large.
    #[cfg(not(target_family = "wasm"))]
    pub fn new(scene: Scene) -> Result<Self> {
        Self::with_options(scene, Options::default())
    }

    /// Creates a simulation with the given [`Options`]: backend, integrator, broad phase and others.
    ///
    /// # Errors
    /// As for [`Simulation::new`], and [`Error::NoAdapter`] when a GPU is requested and there is none.
    #[cfg(not(target_family = "wasm"))]
    pub fn with_options(scene: Scene, options: Options) -> Result<Self> {
        engine::block_on(None, Self::with_options_async(scene, options))
    }

    /// [`Simulation::with_options`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::with_options`].
    pub async fn with_options_async(scene: Scene, options: Options) -> Result<Self> {
        let scene = resolve(scene, &options)?;
        let pack = |backend: Backend| prepare(&scene, &options, scene.first_time_step(), backend);
        let (world, engine, info) = open(&options, pack).await?;
        Ok(Self::assemble(scene, options, world, engine, info))
    }

    /// Creates a simulation on the caller's wgpu device. [`Simulation::gpu_view`] gives access to its buffers.
    ///
    /// # Errors
    /// As for [`Simulation::new`], and [`Error::DeviceLimit`] for a scene that exceeds a limit of
    /// the device.
    #[cfg(feature = "gpu")]
    pub fn on_device(scene: Scene, options: Options, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let scene = resolve(scene, &options)?;
        let dt = scene.first_time_step();
        Self::on_device_as_is(scene, options, (dt, &Kept::default()), device, queue)
    }

    /// [`Simulation::on_device`] for a scene whose constants are resolved already, with its time step and what it keeps.
    #[cfg(feature = "gpu")]
    fn on_device_as_is(
        scene: Scene,
        options: Options,
        (dt, kept): (f32, &Kept<'_>),
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Self> {
        let mut world = prepare(&scene, &options, dt, Backend::Gpu)?;
        kept.put(&mut world, &scene);
        let (engine, info) = Engine::on_device(device, queue, &world)?;
        Ok(Self::assemble(scene, options, world, engine, info))
    }

    /// Creates a simulation on a GPU that others share, with the kernels that are compiled already.
    #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
    pub(crate) fn on_gpu(scene: Scene, options: Options, gpu: &Gpu, info: &BackendInfo) -> Result<Self> {
        let scene = resolve(scene, &options)?;
        let world = prepare(&scene, &options, scene.first_time_step(), info.kind)?;
        let engine = Engine::on(gpu, &world)?;
        Ok(Self::assemble(scene, options, world, engine, info.clone()))
    }

    fn assemble(scene: Scene, mut options: Options, mut world: World, engine: Engine, info: BackendInfo) -> Self {
        engine.complete(&mut world);
        // A later change of the contact law must not change it, and a checkpoint stores it.
        options.integrator = scene.integrator(options.integrator).into();
        let time_step = scene.first_time_step();
        let flow = FlowState::of(&scene);
        let lists = ListPolicy::start(engine.dispatches() && world.movers() <= FEW_MOVERS);
        Self {
            packed: scene.sphere_ids().collect(),
            packed_bodies: BodyHandles::of(&scene),
            packed_ids: ids_of(&scene),
            planes: Planes::start(&scene),
            disorder: Disorder::default(),
            packings: 1,
            status: world.status,
            scene,
            options,
            info,
            engine,
            world,
            report: Report::default(),
            clock: Clock::default(),
            time_step,
            muscle_clock: MuscleClock::default(),
            lists,
            portioning: Portioning::default(),
            dirty: Dirty::Clean,
            edits: Vec::new(),
            aabbs_due: true,
            lists_due: true,
            observation: None,
            synced: true,
            forces_synced: true,
            flow,
            frames: None,
            frames_due: true,
            drives_due: false,
            loads_due: false,
            pulls: None,
            watched: Watched::default(),
            calm_steps: 0,
            few_steps: 0,
        }
    }

    /// The backend that runs the simulation, and why it was chosen.
    pub fn backend(&self) -> &BackendInfo {
        &self.info
    }

    /// The integrator, which advances positions and velocities: the requested one, or the one that [`Scene::integrator`] chose
    /// at the start.
    pub fn integrator(&self) -> Integrator {
        self.scene.integrator(self.options.integrator)
    }

    /// The method that finds pairs: the requested one, or the one chosen for the number of objects and the backend.
    pub fn broad_phase_method(&self) -> BroadPhase {
        self.options.broad_phase.resolve(self.world.objects() as usize, self.info.kind == Backend::Cpu)
    }

    /// The physical constants. If [`Settings::resting_overlap`] is positive, they include the contact constants chosen for it.
    pub fn settings(&self) -> &Settings {
        &self.scene.settings
    }

    /// Changes the physical constants from the next step on.
    ///
    /// If [`Settings::resting_overlap`] is positive, and it, gravity or the contact constants change, contact force and damping
    /// are chosen again, from the positions that were read back last. Nothing else makes the simulation choose them again. They
    /// stay the same while bodies move, when bodies are added or removed, and when a simulation is resumed.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a value is not allowed. Nothing is changed then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<()> {
        settings.validate()?;
        let decides = |s: &Settings| (s.resting_overlap, s.gravity, s.gravity_direction, s.contact_force, s.contact_damping);
        let same = decides(&settings) == decides(&self.scene.settings) && settings.precision != Precision::Auto;
        let before = std::mem::replace(&mut self.scene.settings, settings);
        if let Err(error) = self.check_contact_law() {
            self.scene.settings = before;
            return Err(error);
        }
        if !same {
            self.scene.settings = self.scene.with_grains().resolved_settings();
        }
        let now = self.scene.settings;
        let has_table = now.contact_law.has_history() || self.scene.whole_bodies().next().is_some();
        let rules = |settings: &Settings| (settings.collisions, settings.continuous_collisions);
        // Networks become bodies, or bodies networks.
        let may_change = has_table || self.scene.rods().iter().any(|rod| rod.length.is_some());
        let table_changes = may_change && rules(&before) != rules(&now);
        if before.contact_law != now.contact_law || before.precision != now.precision || table_changes {
            self.dirty = Dirty::Everything;
        } else if has_table && !only_gravity_differs(&before, &now) {
            // The table of pairs has constants that follow from the settings.
            self.dirty = self.dirty.max(Dirty::Topology);
        }
        if before != now {
            self.frames_due = true;
            self.status.forces_due = 1;
            self.observation = None;
        }
        let flags = self.world.step.constants.flags;
        self.world.set_settings(&now);
        // Another precision takes effect when the scene is packed again.
        self.world.set_flags(FLAG_DOUBLE, flags);
        Ok(())
    }

    /// Checks that the contact law has all that it needs.
    fn check_contact_law(&self) -> Result<()> {
        check_contact_law(&self.scene, self.integrator(), self.options.contact_force_law.as_ref())?;
        if self.scene.is_rigid() {
            frames::check::check(&self.scene)?;
        }
        self.engine.check_frames(self.scene.is_rigid())
    }

    /// The report on all steps so far.
    pub fn report(&self) -> Report {
        self.report
    }

    /// The time step of the last `step`, `run`, `update_positions` or [`set_time_step`](Self::set_time_step), in s. Before
    /// the first of them that of [`Scene::run`], or 0.02. AABBs are grown for it.
    pub fn time_step(&self) -> f32 {
        self.time_step
    }

    /// Runs one step of `dt` seconds: AABBs, broad phase, collisions unless they are switched off, forces and integration.
    ///
    /// # Errors
    /// - [`Error::Invalid`] for a time step that is not positive and finite.
    /// - [`Error::NonFinite`] when the state of a body stops being finite in the step, unless
    ///   `keep_going` is set in the [`Options`].
    /// - [`Error::Device`] when the GPU fails.
    #[cfg(not(target_family = "wasm"))]
    pub fn step(&mut self, dt: f32) -> Result<Report> {
        self.run(1, dt)
    }

    /// Runs `steps` steps of `dt` seconds each, submitted together if the backend supports it.
    ///
    /// # Errors
    /// As for [`Simulation::step`]. The steps before the failing one are done.
    #[cfg(not(target_family = "wasm"))]
    pub fn run(&mut self, steps: u64, dt: f32) -> Result<Report> {
        let device = self.engine.waiter();
        engine::block_on(device, self.run_async(steps, dt))
    }

    /// [`Simulation::run`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::run`].
    pub async fn run_async(&mut self, steps: u64, dt: f32) -> Result<Report> {
        self.run_recorded(steps, dt, None).await?;
        Ok(self.report)
    }

    async fn run_recorded(&mut self, steps: u64, dt: f32, recorder: Option<&mut Recorder>) -> Result<()> {
        self.set_time_step(dt)?;
        self.drive(self.step_phases(), steps, recorder).await
    }

    /// The phases of a whole step, in the order in which they run.
    fn step_phases(&self) -> &'static [Phase] {
        let has_phase = self.scene.settings.collisions || self.world.step.traits().friction_impulses;
        if has_phase { &drive::COLLISIONS_FIRST } else { &drive::WITHOUT_COLLISIONS }
    }

    /// Runs phase 1 alone: computes the AABBs of all objects, grown for the current time step.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn update_aabbs(&mut self) -> Result<()> {
        self.phase(Phase::UpdateAabbs)
    }

    /// Runs phase 2 alone: builds the pair lists from the current AABBs.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn broad_phase(&mut self) -> Result<()> {
        self.phase(Phase::BroadPhase)
    }

    /// Runs phase 3 alone: handles collisions, whether or not they are switched on. It uses the existing pair lists. If objects
    /// were added, removed or moved by an edit, or moved out of their AABBs, the lists are rebuilt first.
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    #[cfg(not(target_family = "wasm"))]
    pub fn handle_collisions(&mut self) -> Result<()> {
        self.phase(Phase::HandleCollisions)
    }

    /// Runs phase 4 alone: forces, integration and constraints. Counts as a step. It uses the existing pair lists in the same
    /// way as [`Simulation::handle_collisions`].
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

    /// Runs one phase alone, without blocking. [`Phase::UpdatePositions`] uses the current [`time_step`](Self::time_step).
    ///
    /// # Errors
    /// As for [`Simulation::step`].
    pub async fn phase_async(&mut self, phase: Phase) -> Result<()> {
        self.drive(&[phase], 1, None).await
    }

    /// The acceleration of gravity in the current settings, in units/s².
    pub fn gravity(&self) -> Vec3 {
        Vec3::from_array(self.world.step.constants.gravity)
    }
}

/// Handles of all objects that can touch, for contact laws with history.
fn ids_of(scene: &Scene) -> Vec<AnyId> {
    if scene.settings.contact_law.has_history() { scene.any_ids() } else { Vec::new() }
}

/// Opens the GPU that the options ask for; `None` for the CPU.
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(crate) fn open_device(options: &Options) -> Result<(Option<Gpu>, BackendInfo)> {
    engine::block_on(None, engine::open_device(options))
}

/// Resolves the constants of a scene that its settings leave to be chosen, and chooses the contact law of the options.
fn resolve(mut scene: Scene, options: &Options) -> Result<Scene> {
    scene.settings.validate()?;
    if options.contact_force_law.is_some() && scene.settings.contact_law != ContactLaw::User {
        scene.settings.set("contact_law", ContactLaw::User.name())?;
    }
    scene.settings = scene.with_grains().resolved_settings();
    scene.imply_bodies();
    Ok(scene)
}

/// Checks that the contact law of a scene has all that it needs.
fn check_contact_law(scene: &Scene, integrator: Integrator, law: Option<&ContactForceLaw>) -> Result<()> {
    scene.with_grains().check_contact_law(integrator)?;
    if scene.settings.contact_law == ContactLaw::User && law.is_none() {
        return Err(Error::Invalid {
            field: "contact_law",
            value: ContactLaw::User.name().to_owned(),
            expected: "a law of the program: Options::contact_force_law, in Python Simulation(contact_law=...); a scene alone \
                       cannot define one",
        });
    }
    Ok(())
}

/// Packs a scene for the backend of the options, and opens that. If it is found to be another one, the scene is packed again where
/// its order of memory differs.
async fn open(options: &Options, pack: impl Fn(Backend) -> Result<World>) -> Result<(World, Engine, BackendInfo)> {
    let world = pack(options.backend)?;
    let (engine, info) = Engine::open(options, &world).await?;
    let method = |backend: Backend| options.broad_phase.resolve(world.objects() as usize, backend == Backend::Cpu);
    let is_right = method(options.backend) == method(info.kind);
    // A backend that is not known counts as a GPU, so it is the CPU, whose engine has no copy of the world.
    let world = if is_right { world } else { pack(info.kind)? };
    Ok((world, engine, info))
}

/// Packs a scene for steps of `dt` seconds on a backend, after all checks.
fn prepare(scene: &Scene, options: &Options, dt: f32, backend: Backend) -> Result<World> {
    scene.settings.validate()?;
    check_contact_law(scene, scene.integrator(options.integrator), options.contact_force_law.as_ref())?;
    if scene.is_rigid() {
        frames::check::check(scene)?;
        frames::check::check_rods(scene)?;
    }
    if scene.is_periodic() && options.broad_phase == BroadPhase::SortAndSkip {
        let value = options.broad_phase.to_string();
        return Err(Error::Invalid { field: "broad_phase", value, expected: "auto, grid or brute-force for a periodic scene" });
    }
    let mut world = pack(scene, options, dt, backend)?;
    place_walls(&mut world, scene, &MuscleClock::default());
    if let Some(capacity) = options.pair_capacity {
        world.set_pair_room(capacity.div_ceil(SLICE));
    }
    if options.keep_going {
        world.set_flags(FLAG_CONTINUE, FLAG_CONTINUE);
    }
    Ok(world)
}

/// Packs a scene into a world in the order of memory that suits the broad phase, without scratch arrays, for steps of `dt` seconds.
fn pack(scene: &Scene, options: &Options, dt: f32, backend: Backend) -> Result<World> {
    let counts = scene.counts();
    let objects = counts.spheres + counts.rods + counts.boxes + counts.polygons;
    let broad_phase = match options.uses(Optimization::SpatialOrder) {
        true => options.broad_phase.resolve(objects, backend == Backend::Cpu),
        false => BroadPhase::BruteForce,
    };
    let mut world =
        World::for_method(scene, broad_phase, UserLaws::new(&options.force_laws, options.contact_force_law.as_ref())?)?;
    if !options.uses(Optimization::LargeSpheres) {
        world.leave_out_large_spheres();
    }
    if !options.uses(Optimization::LongMovers) {
        world.leave_out_long_movers();
    }
    world.set_integrator(scene.integrator(options.integrator));
    world.set_residues(has_residues(dt));
    world.joins_steps = options.uses(Optimization::JoinedSteps);
    Ok(world)
}

/// Whether no contact constant changes with the settings. Gravity then changes without packing the scene again, so that a program
/// can turn it every few steps.
fn only_gravity_differs(before: &Settings, after: &Settings) -> bool {
    let Settings { gravity, gravity_direction, .. } = *before;
    after.resting_overlap == 0.0 && *before == Settings { gravity, gravity_direction, ..*after }
}
