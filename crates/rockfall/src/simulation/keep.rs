//! Takes checkpoints and resumes from them.

use std::mem::take;
use std::path::Path;

use crate::checkpoint::{Checkpoint, History};
use crate::error::{Error, Result};
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
use crate::exec::gpu::Gpu;
use crate::model::layout::SLICE;
use crate::model::world::World;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
use crate::options::BackendInfo;
use crate::options::{Backend, Options};
use crate::simulation::edit::Dirty;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
use crate::simulation::engine::Engine;
use crate::simulation::frames::Frames;
use crate::simulation::kept::Kept;
use crate::simulation::lists::ListPolicy;
use crate::simulation::order::Disorder;
use crate::simulation::planes::Planes;
use crate::simulation::{Simulation, check_contact_law, engine, open, prepare};
use crate::step::walls::move_walls::place_walls;
use crate::user_laws::set::UserLaws;

/// What a checkpoint has for a world that is packed from its scene.
fn kept(checkpoint: &Checkpoint) -> Kept<'_> {
    Kept { springs: &checkpoint.springs, rates: &checkpoint.rates, residues: &checkpoint.residues }
}

impl Simulation {
    /// Takes a checkpoint, which holds everything that determines the following steps. Taking it does not change those steps.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails. [`Error::Invalid`] between [`handle_collisions`](Self::handle_collisions) and
    /// [`update_positions`](Self::update_positions), when a step is not complete.
    pub fn checkpoint(&mut self) -> Result<Checkpoint> {
        let device = self.engine.waiter();
        engine::block_on(device, self.checkpoint_async())
    }

    /// [`Simulation::checkpoint`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::checkpoint`].
    pub async fn checkpoint_async(&mut self) -> Result<Checkpoint> {
        if self.status.collided != 0 {
            return Err(Error::Invalid {
                field: "checkpoint",
                value: "a state between two phases".to_owned(),
                expected: "a state between two steps: call update_positions after handle_collisions",
            });
        }
        self.sync_async().await?;
        let springs = self.springs().await?;
        let rates = self.rates().await?;
        let residues = self.residues(&[]);
        let (step, lists) = (&self.world.step, self.lists.settings());
        Ok(Checkpoint {
            scene: self.scene.clone(),
            options: Options {
                backend: self.info.kind,
                pair_capacity: Some(step.layout.pair_rows.saturating_mul(SLICE)),
                ..self.options.clone()
            },
            time_step: self.time_step,
            report: self.report,
            note: String::new(),
            device: self.info.device.clone(),
            program: env!("CARGO_PKG_VERSION").to_owned(),
            history: History {
                lengths_due: self.status.lengths_due != 0,
                margin_scale: lists.margin,
                lookahead: lists.lookahead,
                clock: self.muscle_clock,
            },
            flow: self.flow.clone(),
            springs,
            rates,
            residues,
            frames: self.frame_words()?,
            fronts: self.planes.bases().to_vec(),
            kept_laws: Vec::new(),
            kept_contact_law: None,
        })
    }

    /// Writes a checkpoint to a file; see [`Checkpoint::save`].
    ///
    /// # Errors
    /// As for [`Simulation::checkpoint`] and [`Checkpoint::save`].
    pub fn save_checkpoint(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.checkpoint()?.save(path)
    }

    /// Resumes from a checkpoint. With the same options on the same device, the results are bitwise identical to those of a run
    /// that never stopped. Only `replays` and `list_builds` of the [`Report`](crate::Report) may differ, because lists are
    /// rebuilt.
    ///
    /// # Errors
    /// As for [`Simulation::with_options`]. [`Error::NoAdapter`] when the checkpoint ran on a GPU and there is none. [`Error::Law`]
    /// when the checkpoint lacks a law that the simulation had ([`Checkpoint::give_force_law`],
    /// [`Checkpoint::give_contact_force_law`]).
    #[cfg(not(target_family = "wasm"))]
    pub fn resume(checkpoint: Checkpoint) -> Result<Self> {
        engine::block_on(None, Self::resume_async(checkpoint))
    }

    /// [`Simulation::resume`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::resume`].
    pub async fn resume_async(mut checkpoint: Checkpoint) -> Result<Self> {
        checkpoint.check_laws()?;
        checkpoint.scene.imply_bodies();
        let pack = |backend: Backend| -> Result<World> {
            let mut world = prepare(&checkpoint.scene, &checkpoint.options, checkpoint.time_step, backend)?;
            kept(&checkpoint).put(&mut world, &checkpoint.scene);
            place_walls(&mut world, &checkpoint.scene, &checkpoint.history.clock);
            Ok(world)
        };
        let (world, engine, info) = open(&checkpoint.options, pack).await?;
        let simulation = Self::assemble(take(&mut checkpoint.scene), take(&mut checkpoint.options), world, engine, info);
        simulation.with_history(&checkpoint)
    }

    /// [`Simulation::resume`] on the caller's wgpu device; see [`Simulation::on_device`].
    ///
    /// # Errors
    /// As for [`Simulation::on_device`].
    #[cfg(feature = "gpu")]
    pub fn resume_on_device(mut checkpoint: Checkpoint, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        checkpoint.check_laws()?;
        checkpoint.scene.imply_bodies();
        let (scene, options) = (take(&mut checkpoint.scene), take(&mut checkpoint.options));
        let simulation = Self::on_device_as_is(scene, options, (checkpoint.time_step, &kept(&checkpoint)), device, queue)?;
        simulation.with_history(&checkpoint)
    }

    /// [`Simulation::resume`] on a GPU that others share.
    #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
    pub(crate) fn resume_on_gpu(mut checkpoint: Checkpoint, gpu: &Gpu, info: &BackendInfo) -> Result<Self> {
        checkpoint.check_laws()?;
        checkpoint.scene.imply_bodies();
        let options = Options { backend: info.kind, ..take(&mut checkpoint.options) };
        let mut world = prepare(&checkpoint.scene, &options, checkpoint.time_step, info.kind)?;
        kept(&checkpoint).put(&mut world, &checkpoint.scene);
        place_walls(&mut world, &checkpoint.scene, &checkpoint.history.clock);
        let engine = Engine::on(gpu, &world)?;
        let simulation = Self::assemble(take(&mut checkpoint.scene), options, world, engine, info.clone());
        simulation.with_history(&checkpoint)
    }

    /// Replaces the state by that of a checkpoint, without opening a device again. Handles of the simulation that took the
    /// checkpoint are valid afterwards.
    /// The objects, the constants, the parameters of laws and the [`Report`](crate::Report) become those of the checkpoint. The backend and the
    /// [`Options`] stay; the options in the checkpoint are ignored. The following steps are bitwise identical to those of a
    /// simulation that was resumed from the checkpoint with these options.
    ///
    /// # Errors
    /// [`Error::Invalid`] for settings that are not allowed, [`Error::Device`] when the GPU fails, [`Error::DeviceLimit`] when
    /// the scene is too large, [`Error::Law`] when the laws of the simulation are not those of the checkpoint.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        checkpoint.scene.settings.validate()?;
        let forces = checkpoint.restored_laws(&self.options.force_laws)?;
        let contact = checkpoint.restored_contact_law(self.options.contact_force_law.as_ref())?;
        check_contact_law(&checkpoint.scene, self.integrator(), contact.as_ref())?;
        self.engine.check_frames(checkpoint.scene.is_rigid())?;
        // The contact law may name materials of the checkpoint.
        let laws = UserLaws::new(&forces, contact.as_ref())?;
        laws.values(&checkpoint.scene.material_names())?;
        self.engine.check_laws(&laws)?;
        let frames = Frames::of_words(&checkpoint.scene, &checkpoint.frames)?;
        self.put_laws(laws, forces, contact);
        // `rebuild` packs the scene, and the state on the device is replaced, so nothing has to be read back or applied.
        (self.dirty, self.synced, self.forces_synced) = (Dirty::Clean, true, true);
        self.edits.clear();
        self.scene = checkpoint.scene.clone();
        self.apply_history(checkpoint);
        self.put_frames(frames);
        self.rebuild(&kept(checkpoint))?;
        self.status.collided = 0;
        self.watch_anew()
    }

    /// Continues with what a checkpoint has beside its scene, its options and its springs.
    fn with_history(mut self, checkpoint: &Checkpoint) -> Result<Self> {
        self.apply_history(checkpoint);
        self.put_frames(Frames::of_words(&self.scene, &checkpoint.frames)?);
        self.disorder = Disorder::sorted_at(checkpoint.report.steps);
        Ok(self)
    }

    fn apply_history(&mut self, checkpoint: &Checkpoint) {
        let history = checkpoint.history;
        self.time_step = checkpoint.time_step;
        self.report = checkpoint.report;
        self.planes = Planes::resumed(&self.scene, &checkpoint.fronts);
        self.flow = checkpoint.flow.clone();
        self.muscle_clock = history.clock;
        self.status.lengths_due = u32::from(history.lengths_due);
        self.status.forces_due = self.world.status.forces_due;
        // Passages are looked for after deep overlaps.
        self.status.last_max_overlap = checkpoint.report.max_overlap.to_bits();
        self.lists = ListPolicy::new(history.lookahead, history.margin_scale);
    }
}
