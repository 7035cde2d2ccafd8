//! Many small worlds that advance side by side.

use rayon::prelude::*;

use glam::Vec3;

use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
#[cfg(feature = "gpu")]
use crate::exec::gpu::Gpu;
use crate::model::world_sizes::WorldSizes;
use crate::options::{Backend, BackendInfo, Options};
use crate::report::{Report, SphereState};
use crate::scene::Scene;
use crate::settings::{DEFAULT_TIME_STEP, Integrator};
use crate::simulation::Simulation;

mod checkpoint;
mod control;
#[cfg(feature = "gpu")]
mod device;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod joined;
mod joints;
mod observe;
mod room;
mod sample;
mod sleep;
#[cfg(feature = "gpu")]
use device::Batch;
pub use sample::Sample;
pub use sleep::Sleep;

/// A batch of scenes that advance side by side, each in its own world.
///
/// Worlds do not affect each other. Each has its own objects, statics and settings, in its own coordinates, and advances exactly as
/// in a [`Simulation`] of its own with the same options on the same device: the results are bitwise identical, whatever other worlds
/// are in the batch and in whichever place a world is. A world in which a body stops being finite is stopped and reported
/// ([`WorldReport::stopped`]), and the other worlds go on.
///
/// Worlds are numbered from 0 in the order of the scenes. On the CPU backend they are divided among the threads of rayon's pool.
#[derive(Debug)]
pub struct Worlds {
    options: Options,
    info: BackendInfo,
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
    /// The worlds that run on the device, in workgroups of one or a few.
    #[cfg(feature = "gpu")]
    batch: Option<Batch>,
    /// The worlds that share frames on the device.
    #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
    joined: joined::Joined,
    /// The integrator of the worlds in workgroups.
    #[cfg(feature = "gpu")]
    shared: Integrator,
    sleep: Sleep,
    /// Time step of the last run, in s.
    dt: f32,
    worlds: Vec<World>,
}

#[derive(Debug)]
struct World {
    /// The simulation that runs the world or, on [`WorldPath::Device`], holds its objects on the host.
    simulation: Simulation,
    path: WorldPath,
    /// The state that [`Worlds::reset`] returns to.
    start: Checkpoint,
    /// Why the world does not advance any more.
    stopped: Option<String>,
    /// Steps one after the other, up to now, at whose end no sphere moved. Not counted by simulations on a GPU.
    calm: u32,
}

/// How a world is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WorldPath {
    /// By a simulation of its own, which supports all objects and settings. On a GPU its steps are dispatched one world after the
    /// other.
    Simulation,
    /// With other worlds under the contact law `rigid`, in frames that they share on the GPU. Such worlds have no springs, tethers,
    /// motions and periodic boundaries, and the same walls, at most 64, gravity, materials and number of substeps. They do not sleep.
    Joined,
    /// By a workgroup of the GPU, which runs many steps in one dispatch, side by side with other worlds; small worlds of large
    /// batches share a workgroup. This path takes worlds of up to 32 spheres, 64 objects and 128 springs, with RK4 or symplectic
    /// Euler, the contact law of the thesis and single precision. They have no rods, materials, collisions as impulses
    /// ([`Settings::collisions`](crate::Settings::collisions)) and friction impulses. A world that replaces another one takes it if
    /// it is not larger than the largest world was when the batch was created.
    Device,
}

/// The report on one world.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct WorldReport {
    /// Counts and times of all steps of this world since it was created, replaced or reset.
    pub report: Report,
    /// How the world is run. Results do not depend on it.
    pub path: WorldPath,
    /// Why the world does not advance any more: the message of [`Error::NonFinite`] or of an error of the device. `None` while it
    /// advances.
    pub stopped: Option<String>,
    /// The first sphere, in order of addition, whose centre is outside of the bounds of [`Worlds::report`]. `None` when all are
    /// inside.
    pub escaped: Option<usize>,
    /// Whether everything in the world rests ([`Sleep`]).
    pub sleeping: bool,
}

impl World {
    fn new(mut simulation: Simulation, path: WorldPath) -> Result<Self> {
        let start = simulation.checkpoint()?;
        Ok(Self { simulation, path, start, stopped: None, calm: 0 })
    }

    fn reset(&mut self) -> Result<()> {
        self.stopped = None;
        self.simulation.restore(&self.start)
    }
}

impl Worlds {
    /// Spheres of a body that fits into a workgroup ([`WorldPath::Device`]) together with [`Worlds::BODY_MUSCLES`] and 44
    /// boxes.
    pub const BODY_SPHERES: usize = WorldSizes::BODY_SPHERES;

    /// Springs with muscles of such a body.
    pub const BODY_MUSCLES: usize = WorldSizes::BODY_MUSCLES;

    /// Creates a world for each scene. All worlds have the same options.
    ///
    /// With [`Backend::Auto`] they run on a hardware GPU if there is one, otherwise on the CPU.
    ///
    /// # Errors
    /// As for [`Simulation::with_options`], for the first scene that is refused. [`Error::Law`](crate::Error::Law) for options with
    /// force laws or a contact law. [`Error::Invalid`] for more than 1,048,576 worlds, and for worlds that do not fit in memory.
    pub fn new(scenes: impl IntoIterator<Item = Scene>, options: Options) -> Result<Self> {
        if let Some(law) = options.force_laws.first() {
            return Err(law.error("Worlds do not take force laws, expected a Simulation for each scene"));
        }
        if let Some(law) = &options.contact_force_law {
            return Err(law.error("Worlds do not take contact laws of the program, expected a Simulation for each scene"));
        }
        let mut worlds = Self::empty(options)?;
        let scenes = room::collected(scenes)?;
        #[cfg(feature = "gpu")]
        {
            worlds.shared = device::shared_integrator(&scenes, &worlds.options);
        }
        worlds.worlds = worlds.create_all(scenes)?;
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &worlds.gpu {
            worlds.batch = Some(Batch::new(gpu, &mut worlds.worlds, WorldSizes::default())?);
        }
        Ok(worlds)
    }

    /// Replaces all worlds by a world for each of these scenes, at time 0. The device and its compiled kernels stay, so this is faster
    /// than new worlds: opening a GPU takes a good part of a second.
    ///
    /// # Errors
    /// As for [`Worlds::new`]. The worlds are unchanged then.
    pub fn replace_all(&mut self, scenes: impl IntoIterator<Item = Scene>) -> Result<()> {
        let scenes = room::collected(scenes)?;
        #[cfg(feature = "gpu")]
        {
            let before = std::mem::replace(&mut self.shared, device::shared_integrator(&scenes, &self.options));
            let replaced = self.replace_worlds(scenes);
            if replaced.is_err() {
                self.shared = before;
            }
            replaced
        }
        #[cfg(not(feature = "gpu"))]
        self.replace_worlds(scenes)
    }

    fn replace_worlds(&mut self, scenes: Vec<Scene>) -> Result<()> {
        let mut worlds = self.create_all(scenes)?;
        #[cfg(feature = "gpu")]
        if let (Some(batch), Some(gpu)) = (&mut self.batch, &self.gpu) {
            // With room for the former worlds the kernel stays the same in most cases.
            *batch = Batch::new(gpu, &mut worlds, batch.sizes().without_pairs())?;
        }
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        {
            self.joined = joined::Joined::default();
        }
        std::mem::swap(&mut self.worlds, &mut worlds);
        // Thousands of worlds have millions of allocations.
        worlds.into_par_iter().for_each(drop);
        Ok(())
    }

    #[cfg(feature = "gpu")]
    fn empty(options: Options) -> Result<Self> {
        let (gpu, info) = crate::simulation::open_device(&options)?;
        let (options, sleep, shared) = (options.backend(info.kind), Sleep::default(), Integrator::default());
        Ok(Self {
            options,
            info,
            gpu,
            batch: None,
            #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
            joined: joined::Joined::default(),
            shared,
            sleep,
            dt: DEFAULT_TIME_STEP,
            worlds: Vec::new(),
        })
    }

    #[cfg(not(feature = "gpu"))]
    fn empty(options: Options) -> Result<Self> {
        // Another backend is refused in the way of a simulation.
        let info = Simulation::with_options(Scene::new(), options.clone())?.backend().clone();
        let (options, sleep) = (options.backend(info.kind), Sleep::default());
        Ok(Self { options, info, sleep, dt: DEFAULT_TIME_STEP, worlds: Vec::new() })
    }

    fn create_all(&self, scenes: Vec<Scene>) -> Result<Vec<World>> {
        if let Some(world) = scenes.iter().position(|scene| !(scene.inlets().is_empty() && scene.outlets().is_empty())) {
            return Err(Error::Invalid {
                field: "worlds",
                value: format!("a scene with inlets or outlets for world {world}"),
                expected: "scenes without inlets and outlets: a Simulation for each of these",
            });
        }
        // Each is packed by one thread.
        let on_host: Vec<Result<Option<World>>> = scenes.par_iter().map(|scene| self.create_on_host(scene)).collect();
        let complete = |(world, scene): (Result<Option<World>>, Scene)| match world? {
            Some(world) => Ok(world),
            None => self.create_on_device(scene),
        };
        on_host.into_iter().zip(scenes).map(complete).collect()
    }

    fn create(&self, scene: Scene) -> Result<World> {
        self.create_all(vec![scene])?.pop().ok_or_else(|| self.no_world(0))
    }

    /// A world whose objects are on the host; `None` for one that needs a simulation on the device.
    fn create_on_host(&self, scene: &Scene) -> Result<Option<World>> {
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let (Some(_), Some(holder)) = (&self.gpu, joined::holder(scene, &self.options)?) {
            return World::new(holder, WorldPath::Joined).map(Some);
        }
        #[cfg(feature = "gpu")]
        if self.gpu.is_some() {
            let mirror = device::mirror(scene, &self.options, self.shared)?;
            return mirror.map(|mirror| World::new(mirror, WorldPath::Device)).transpose();
        }
        let simulation = Simulation::with_options(scene.clone(), self.options.clone())?;
        World::new(simulation, WorldPath::Simulation).map(Some)
    }

    fn create_on_device(&self, scene: Scene) -> Result<World> {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            let simulation = Simulation::on_gpu(scene, self.options.clone(), gpu, &self.info)?;
            return World::new(simulation, WorldPath::Simulation);
        }
        World::new(Simulation::with_options(scene, self.options.clone())?, WorldPath::Simulation)
    }

    /// Sets whether small worlds share workgroups on the device. Otherwise their number decides. For tests: results do not change.
    #[cfg(feature = "gpu")]
    #[doc(hidden)]
    pub fn share_workgroups(&mut self, shared: bool) {
        if let Some(batch) = &mut self.batch {
            batch.share_workgroups(shared);
        }
    }

    /// Replaces the kernel of the worlds on the device. For tests that put mistakes into it.
    #[cfg(feature = "gpu")]
    #[doc(hidden)]
    pub fn set_kernel(&mut self, stage: &'static crate::step::stage::Stage) {
        if let Some(batch) = &mut self.batch {
            batch.set_kernel(stage);
        }
    }

    /// Number of worlds.
    pub fn len(&self) -> usize {
        self.worlds.len()
    }

    /// Whether there are no worlds.
    pub fn is_empty(&self) -> bool {
        self.worlds.is_empty()
    }

    /// The backend that runs the worlds, and why it was chosen.
    pub fn backend(&self) -> &BackendInfo {
        &self.info
    }

    /// The integrator of a world. With [`IntegratorChoice::Auto`](crate::IntegratorChoice::Auto) in the options, worlds with different
    /// contact laws or values of [`Scene::run`] may have different ones.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist.
    pub fn integrator(&self, world: usize) -> Result<Integrator> {
        Ok(self.world(world)?.simulation.integrator())
    }

    /// The options of all worlds.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Advances every world that is not stopped by `steps` steps of `dt` seconds. Sleeping worlds stand still if
    /// [`Sleep::skip`] is set.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a time step that is not positive and finite. Errors of single worlds stop these worlds and are in
    /// their reports. [`Error::Device`] when the GPU fails.
    pub fn run(&mut self, steps: u64, dt: f32) -> Result<()> {
        self.set_time_step(dt)?;
        #[cfg(feature = "gpu")]
        if let (Some(batch), Some(gpu)) = (&mut self.batch, &self.gpu) {
            batch.run(&mut self.worlds, steps, dt, (self.shared, &self.sleep), |checkpoint| {
                Simulation::resume_on_gpu(checkpoint, gpu, &self.info)
            })?;
        }
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(gpu) = &self.gpu {
            self.joined
                .run(gpu, &mut self.worlds, steps, dt, |checkpoint| Simulation::resume_on_gpu(checkpoint, gpu, &self.info))?;
        }
        let sleep = &self.sleep;
        match self.info.kind {
            Backend::Cpu => self.worlds.par_iter_mut().for_each(|world| world.run(steps, dt, sleep)),
            _ => self.worlds.iter_mut().for_each(|world| world.run(steps, dt, sleep)),
        }
        Ok(())
    }

    /// Reads the states of the worlds on the device back, if they have changed.
    fn refresh(&mut self) -> Result<()> {
        #[cfg(feature = "gpu")]
        if let Some(batch) = &mut self.batch {
            batch.refresh(&mut self.worlds)?;
        }
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        self.joined.refresh(&mut self.worlds)?;
        Ok(())
    }

    /// A world with its present state on the host or in its own simulation.
    fn current(&mut self, world: usize) -> Result<&mut World> {
        self.world(world)?;
        self.refresh()?;
        Ok(&mut self.worlds[world])
    }

    fn world(&self, world: usize) -> Result<&World> {
        self.worlds.get(world).ok_or_else(|| self.no_world(world))
    }

    fn no_world(&self, world: usize) -> Error {
        Error::Invalid {
            field: "world",
            value: format!("{world} of {}", self.len()),
            expected: "a number below that of worlds",
        }
    }

    /// The scene of a world with its current objects, in the state that was read back last.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist.
    pub fn scene(&self, world: usize) -> Result<&Scene> {
        Ok(self.world(world)?.simulation.scene())
    }

    /// Reads the state of a world back, and returns a scene from which a simulation goes on where the world is.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist, [`Error::Device`] when the GPU fails.
    pub fn snapshot(&mut self, world: usize) -> Result<Scene> {
        self.current(world)?.simulation.snapshot()
    }

    /// The current states of all spheres of a world, in order of addition.
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn states(&mut self, world: usize) -> Result<Vec<SphereState>> {
        self.current(world)?.simulation.spheres()
    }

    /// The current states of all spheres of all worlds: one list per world.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails.
    pub fn all_states(&mut self) -> Result<Vec<Vec<SphereState>>> {
        self.bring_to_host()?;
        let states = |world: &World| world.simulation.scene().spheres().iter().map(SphereState::from).collect();
        Ok(self.worlds.par_iter().map(states).collect())
    }

    /// Brings the present states of all worlds to their scenes: see [`Worlds::scene`].
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails.
    pub fn sync(&mut self) -> Result<()> {
        self.bring_to_host()
    }

    /// Brings the present states of all worlds to the scenes of their simulations.
    fn bring_to_host(&mut self) -> Result<()> {
        self.refresh()?;
        let sync = |world: &mut World| world.simulation.sync().map(|_| ());
        // The states of simulations of their own on a GPU are read one after the other.
        if self.info.kind == Backend::Cpu || self.worlds.iter().all(|world| world.path != WorldPath::Simulation) {
            self.worlds.par_iter_mut().try_for_each(sync)
        } else {
            self.worlds.iter_mut().try_for_each(sync)
        }
    }

    /// Returns worlds to the state in which they were created or replaced, at time 0. Stopped worlds advance again.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist; nothing is changed then. [`Error::Device`] when the GPU fails.
    pub fn reset(&mut self, worlds: &[usize]) -> Result<()> {
        for world in worlds {
            self.world(*world)?;
        }
        self.refresh()?;
        for world in worlds {
            self.worlds[*world].reset()?;
            self.changed(*world);
        }
        Ok(())
    }

    /// Replaces a world by a new one with this scene, at time 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a world that does not exist. Otherwise as for [`Worlds::new`]. The world is unchanged then.
    pub fn replace(&mut self, world: usize, scene: Scene) -> Result<()> {
        self.world(world)?;
        let new = self.create(scene)?;
        self.refresh()?;
        self.worlds[world] = new;
        self.changed(world);
        Ok(())
    }

    /// Notes that a world wakes up and, on the device, must be uploaded again.
    fn changed(&mut self, world: usize) {
        self.worlds[world].calm = 0;
        #[cfg(feature = "gpu")]
        if let Some(batch) = &mut self.batch {
            batch.changed(world);
        }
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        self.joined.changed(world);
    }

    /// Notes that the drives of joints of a world have changed, and nothing else.
    fn drives_changed(&mut self, world: usize) {
        self.worlds[world].calm = 0;
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if self.worlds[world].path == WorldPath::Joined {
            return self.joined.drives_changed(world);
        }
        self.changed(world);
    }

    /// The report on a world. `bounds` are the least and greatest coordinates of the centres of spheres that have not escaped;
    /// `None` for no bounds. With bounds the state is read back.
    ///
    /// # Errors
    /// As for [`Worlds::snapshot`].
    pub fn report(&mut self, world: usize, bounds: Option<[Vec3; 2]>) -> Result<WorldReport> {
        let sleep = self.sleep;
        let world = self.current(world)?;
        let escaped = match bounds {
            Some([least, greatest]) => world.simulation.sync()?.spheres().iter().position(|sphere| {
                let inside = sphere.position.cmpge(least) & sphere.position.cmple(greatest);
                !inside.all()
            }),
            None => None,
        };
        let mut report = world.simulation.report();
        if world.path == WorldPath::Joined && report.steps > 0 {
            // Shared frames count the contacts of all worlds together.
            let contacts = world.simulation.contacts()?;
            report.contacts = contacts.len() as u32;
            report.max_overlap = contacts.iter().map(|contact| contact.overlap).fold(0.0, f32::max);
        }
        Ok(WorldReport {
            report,
            path: world.path,
            stopped: world.stopped.clone(),
            escaped,
            sleeping: world.is_sleeping(&sleep),
        })
    }
}
