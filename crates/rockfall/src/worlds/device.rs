//! The worlds of a batch that run on the device, in workgroups of one or a few.

use rayon::prelude::*;

use crate::checkpoint::Checkpoint;
use crate::error::Result;
use crate::exec::gpu::Gpu;
use crate::exec::gpu::worlds::{DeviceWorlds, Download, Lengths, States};
use crate::model::layout::FLAG_CONTINUE;
use crate::model::muscles::BASE_STEPS;
use crate::model::world_sizes::WorldSizes;
use crate::options::{Backend, Optimization, Options};
use crate::scene::Scene;
use crate::settings::{BroadPhase, DEFAULT_TIME_STEP, Integrator};
use crate::simulation::Simulation;
use crate::simulation::mirror::Elsewhere;
use crate::step::fused::run_worlds::WorldResult;
use crate::step::stage::Stage;
use crate::worlds::{Sleep, World, WorldPath};

/// Worlds that are written to the device together: a bound on the memory that this takes on the host.
const UPLOADED_AT_ONCE: usize = 8192;

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
    /// The host has rest lengths that the device lacks.
    lengths_due: bool,
    /// What the world reported when it was read back or uploaded.
    last: WorldResult,
}

impl Slot {
    const CHANGED: Self = Self { is_uploaded: false, lengths_due: false, last: WorldResult::START };
}

/// The simulation that holds a world on the host while a workgroup runs it; `None` for a world that needs a simulation of its own.
pub(super) fn mirror(scene: &Scene, options: &Options, integrator: Integrator) -> Result<Option<Simulation>> {
    let options = options.clone().backend(Backend::Cpu).broad_phase(BroadPhase::BruteForce).without(Optimization::LargeSpheres);
    let mut simulation = Simulation::with_options(scene.clone(), options)?;
    let does_fit = WorldSizes::of(simulation.packed(DEFAULT_TIME_STEP)?).is_some();
    Ok((does_fit && simulation.integrator() == integrator).then_some(simulation))
}

/// The integrator of the worlds that workgroups run: that of the first scene with one that their kernel has.
pub(super) fn shared_integrator(scenes: &[Scene], options: &Options) -> Integrator {
    let mut integrators = scenes.iter().map(|scene| scene.integrator(options.integrator));
    integrators.find(|integrator| *integrator != Integrator::VelocityVerlet).unwrap_or_default()
}

impl Batch {
    /// Room for worlds as large as the largest of these, and as `least`.
    pub(super) fn new(gpu: &Gpu, worlds: &mut [World], least: WorldSizes) -> Result<Self> {
        let mut sizes = least;
        let on_device = worlds.par_iter_mut().filter(|world| world.path == WorldPath::Device);
        let of = |world: &mut World| world.simulation.packed(DEFAULT_TIME_STEP).map(WorldSizes::of);
        for needed in on_device.map(of).collect::<Vec<_>>() {
            sizes = sizes.max(needed?.unwrap_or_default());
        }
        let device = DeviceWorlds::new(gpu, worlds.len() as u32, sizes)?;
        Ok(Self { device, slots: vec![Slot::CHANGED; worlds.len()], dt: None, steps: 0, is_ahead: false })
    }

    /// The room for a world, and whether the kernel has code for pairs of spheres.
    pub(super) fn sizes(&self) -> WorldSizes {
        self.device.sizes()
    }

    /// Sets whether small worlds share workgroups.
    pub(super) fn share_workgroups(&mut self, shared: bool) {
        self.device.share_workgroups(shared);
    }

    /// Replaces the kernel.
    pub(super) fn set_kernel(&mut self, stage: &'static Stage) {
        self.device.set_kernel(stage);
    }

    /// Notes that a world must be uploaded before it runs.
    pub(super) fn changed(&mut self, world: usize) {
        self.slots[world].is_uploaded = false;
    }

    /// Notes that the rest lengths of a world, and nothing else, must be written before it runs.
    pub(super) fn lengths_changed(&mut self, world: usize) {
        self.slots[world].lengths_due = true;
    }

    /// Whether the device has advanced worlds since they were read back.
    pub(super) fn is_ahead(&self) -> bool {
        self.is_ahead
    }

    /// Whether the device has the present states of all worlds that run.
    pub(super) fn has_all(&self, worlds: &[World]) -> bool {
        let has =
            |(slot, world): (&Slot, &World)| world.path == WorldPath::Device && (slot.is_uploaded || world.stopped.is_some());
        self.slots.iter().zip(worlds).all(has)
    }

    /// Advances the worlds on the device. A world that has grown too large for it gets a simulation from `resume`.
    pub(super) fn run(
        &mut self,
        worlds: &mut [World],
        steps: u64,
        dt: f32,
        (integrator, sleep): (Integrator, &Sleep),
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
            self.write_lengths(worlds)?;
            self.device.run(portion, integrator, (sleep.skipped_after(), sleep.speed))?;
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
        // What a world that is due needs if there is room for it.
        let fits = |(slot, world): (&Slot, &mut World)| {
            let packed = if due(slot, world) { Some(world.simulation.packed(dt)?) } else { None };
            Ok(packed.map(|packed| self.device.fits(packed)))
        };
        let needed: Result<Vec<Option<Option<WorldSizes>>>> = self.slots.par_iter().zip(&mut *worlds).map(fits).collect();
        let needed = needed?;
        if needed.iter().flatten().flatten().any(|sizes| sizes.pairs) {
            self.device.allow_pairs();
        }
        // Whether there is room for a world that is due.
        let fits: Vec<Option<bool>> = needed.iter().map(|due| due.map(|sizes| sizes.is_some())).collect();
        for (world, fits) in worlds.iter_mut().zip(&fits) {
            if *fits == Some(false) {
                world.simulation = resume(world.simulation.checkpoint()?)?;
                world.path = WorldPath::Simulation;
                world.calm = 0;
            }
        }
        let mut first = 0;
        for run in fits.chunk_by(|one, next| one == next) {
            let end = first + run.len();
            if run[0] == Some(true) {
                for from in (first..end).step_by(UPLOADED_AT_ONCE) {
                    let to = end.min(from + UPLOADED_AT_ONCE);
                    self.device.upload(
                        from as u32,
                        &mut worlds[from..to],
                        |world| world.simulation.packed(dt),
                        |world| world.calm,
                    )?;
                }
                self.slots[first..end].fill(Slot { is_uploaded: true, ..Slot::CHANGED });
            }
            first = end;
        }
        Ok(())
    }

    /// Writes the rest lengths that have changed since their worlds were uploaded.
    fn write_lengths(&mut self, worlds: &[World]) -> Result<()> {
        let due = |slot: &Slot| slot.lengths_due && slot.is_uploaded;
        let due: Vec<usize> = (0..worlds.len()).filter(|world| due(&self.slots[*world])).collect();
        for some in due.chunks(UPLOADED_AT_ONCE) {
            let lengths = Lengths::of(self.device.sizes().springs, some, |world| worlds[world].simulation.packed_world());
            self.device.write_lengths(&lengths)?;
            some.iter().for_each(|world| self.slots[*world].lengths_due = false);
        }
        Ok(())
    }

    /// Reads the states of all worlds back, if the device has advanced them.
    pub(super) fn refresh(&mut self, worlds: &mut [World]) -> Result<()> {
        if !std::mem::take(&mut self.is_ahead) {
            return Ok(());
        }
        let slots = &mut self.slots;
        self.device.download(|states| take_states(slots, worlds, states))
    }

    /// Starts to copy the states of all worlds, as they are after the steps so far, without waiting.
    pub(super) fn start_sample(&mut self) -> Result<Download> {
        self.device.start_download()
    }

    /// Waits for such a copy, and shows it.
    pub(super) fn finish_sample<T>(&mut self, sample: Download, show: impl FnOnce(&States<'_>) -> T) -> Result<T> {
        self.device.finish_download(sample, show)
    }
}

/// Copies the states of worlds that run on the device to the host.
fn take_states(slots: &mut [Slot], worlds: &mut [World], states: &States<'_>) {
    slots.par_iter_mut().zip(worlds).enumerate().for_each(|(number, (slot, world))| {
        if world.path != WorldPath::Device || !slot.is_uploaded || world.stopped.is_some() {
            return;
        }
        let now = states.result(number);
        let before = std::mem::replace(&mut slot.last, now);
        // New rest lengths wake a world up.
        world.calm = if slot.lengths_due { 0 } else { now.calm };
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
}
