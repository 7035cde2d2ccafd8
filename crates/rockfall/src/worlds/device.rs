//! The worlds of a batch that run on the device, one workgroup each.

use rayon::prelude::*;

use crate::checkpoint::Checkpoint;
use crate::error::Result;
use crate::exec::gpu::Gpu;
use crate::exec::gpu::worlds::DeviceWorlds;
use crate::model::layout::FLAG_CONTINUE;
use crate::model::muscles::BASE_STEPS;
use crate::model::world_sizes::WorldSizes;
use crate::options::{Backend, Optimization, Options};
use crate::scene::Scene;
use crate::settings::{BroadPhase, DEFAULT_TIME_STEP};
use crate::simulation::Simulation;
use crate::simulation::mirror::Elsewhere;
use crate::step::fused::run_worlds::WorldResult;
use crate::worlds::{World, WorldPath};

/// The device's copies of the worlds.
#[derive(Debug)]
pub(super) struct Batch {
    device: DeviceWorlds,
    slots: Vec<Slot>,
    /// Time step of the last run, which the uploaded worlds have.
    dt: Option<f32>,
    /// Steps since worlds were uploaded.
    steps: u64,
    /// The device has advanced the worlds since they were read back.
    is_ahead: bool,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    is_uploaded: bool,
    /// What the world reported when it was read back or uploaded.
    last: WorldResult,
}

impl Slot {
    const CHANGED: Self = Self { is_uploaded: false, last: WorldResult::START };
}

/// The simulation that holds a world on the host while a workgroup runs it; `None` for a world that needs a simulation of its own.
pub(super) fn mirror(scene: &Scene, options: &Options) -> Result<Option<Simulation>> {
    let options = options.clone().backend(Backend::Cpu).broad_phase(BroadPhase::BruteForce).without(Optimization::LargeSpheres);
    let mut simulation = Simulation::with_options(scene.clone(), options)?;
    let does_fit = WorldSizes::of(simulation.packed(DEFAULT_TIME_STEP)?).is_some();
    Ok(does_fit.then_some(simulation))
}

impl Batch {
    /// Room for worlds as large as the largest of these.
    pub(super) fn new(gpu: &Gpu, worlds: &mut [World]) -> Result<Self> {
        let mut sizes = WorldSizes::default();
        for world in worlds.iter_mut().filter(|world| world.path == WorldPath::Device) {
            sizes = sizes.max(WorldSizes::of(world.simulation.packed(DEFAULT_TIME_STEP)?).unwrap_or_default());
        }
        let device = DeviceWorlds::new(gpu, worlds.len() as u32, sizes)?;
        Ok(Self { device, slots: vec![Slot::CHANGED; worlds.len()], dt: None, steps: 0, is_ahead: false })
    }

    /// Notes that a world must be uploaded before it runs.
    pub(super) fn changed(&mut self, world: usize) {
        self.slots[world].is_uploaded = false;
    }

    /// Advances the worlds on the device. A world that has grown too large for it gets a simulation from `resume`.
    pub(super) fn run(
        &mut self,
        worlds: &mut [World],
        steps: u64,
        dt: f32,
        options: &Options,
        resume: impl Fn(Checkpoint) -> Result<Simulation>,
    ) -> Result<()> {
        let mut left = steps;
        while left > 0 && worlds.iter().any(|world| world.path == WorldPath::Device) {
            // Kernels count the steps since the upload with 32 bits.
            let portion = left.min(BASE_STEPS / 2);
            if self.dt != Some(dt) || self.steps + portion > BASE_STEPS {
                self.refresh(worlds)?;
                (self.dt, self.steps) = (Some(dt), 0);
                self.slots.fill(Slot::CHANGED);
            }
            self.upload(worlds, dt, &resume)?;
            self.device.run(portion, options.integrator)?;
            self.is_ahead = true;
            self.steps += portion;
            left -= portion;
        }
        Ok(())
    }

    fn upload(&mut self, worlds: &mut [World], dt: f32, resume: &impl Fn(Checkpoint) -> Result<Simulation>) -> Result<()> {
        let due = |slot: &Slot, world: &World| world.path == WorldPath::Device && !slot.is_uploaded && world.stopped.is_none();
        if !self.slots.iter().zip(&*worlds).any(|(slot, world)| due(slot, world)) {
            return Ok(());
        }
        self.refresh(worlds)?;
        for (number, (slot, world)) in self.slots.iter_mut().zip(worlds).enumerate() {
            if !due(slot, world) {
                continue;
            }
            let packed = world.simulation.packed(dt)?;
            if self.device.fits(packed) {
                self.device.upload(number as u32, packed)?;
                *slot = Slot { is_uploaded: true, last: WorldResult::START };
            } else {
                world.simulation = resume(world.simulation.checkpoint()?)?;
                world.path = WorldPath::Simulation;
            }
        }
        Ok(())
    }

    /// Reads the states of all worlds back, if the device has advanced them.
    pub(super) fn refresh(&mut self, worlds: &mut [World]) -> Result<()> {
        if !std::mem::take(&mut self.is_ahead) {
            return Ok(());
        }
        let states = self.device.download()?;
        let both = self.slots.par_iter_mut().zip(worlds);
        both.enumerate().for_each(|(number, (slot, world))| {
            if world.path != WorldPath::Device || !slot.is_uploaded || world.stopped.is_some() {
                return;
            }
            let now = states.results[number];
            let before = std::mem::replace(&mut slot.last, now);
            let goes_on = world.simulation.packed_flags() & FLAG_CONTINUE != 0;
            let done = Elsewhere {
                steps: now.steps - before.steps,
                contacts: now.contacts,
                max_overlap: f32::from_bits(now.max_overlap),
                bad: now.total_bad - before.total_bad,
                stopped_by: (now.rejected != 0 && !goes_on).then_some(now.first_bad),
            };
            let taken = world.simulation.take_steps(&done, |host| states.copy_to(number, host));
            world.stopped = taken.err().map(|error| error.to_string());
        });
        Ok(())
    }
}
