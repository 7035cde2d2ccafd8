//! Taking checkpoints, and going on from them.

use std::path::Path;

use crate::checkpoint::{Checkpoint, History};
use crate::error::{Error, Result};
use crate::model::layout::SLICE;
use crate::options::Options;
use crate::simulation::engine::Engine;
use crate::simulation::lookahead::Lookahead;
use crate::simulation::order::Disorder;
use crate::simulation::{Simulation, engine, prepare};

impl Simulation {
    /// Everything that decides how the simulation goes on. The steps after it are the same whether or not it is taken.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU failed; [`Error::Invalid`] within a step, after
    /// [`handle_collisions`](Self::handle_collisions) alone.
    #[cfg(not(target_family = "wasm"))]
    pub fn checkpoint(&mut self) -> Result<Checkpoint> {
        let device = self.engine.waiter();
        engine::block_on(device, self.checkpoint_async())
    }

    /// [`Simulation::checkpoint`] without blocking.
    ///
    /// # Errors
    /// As there.
    pub async fn checkpoint_async(&mut self) -> Result<Checkpoint> {
        if self.status.collided != 0 {
            return Err(Error::Invalid {
                field: "checkpoint",
                value: "a state between two phases".to_owned(),
                expected: "one between two steps: update_positions after handle_collisions",
            });
        }
        self.sync_async().await?;
        let step = &self.world.step;
        Ok(Checkpoint {
            scene: self.scene.clone(),
            options: Options {
                backend: self.info.kind,
                pair_capacity: Some(step.pair_rows.saturating_mul(SLICE)),
                ..self.options.clone()
            },
            time_step: self.time_step,
            report: self.report,
            note: String::new(),
            device: self.info.device.clone(),
            program: env!("CARGO_PKG_VERSION").to_owned(),
            history: History {
                lengths_due: self.status.lengths_due != 0,
                margin_scale: step.margin_scale,
                lookahead: step.lookahead,
            },
        })
    }

    /// Writes a checkpoint to a file; see [`Checkpoint::save`].
    ///
    /// # Errors
    /// As for [`Simulation::checkpoint`] and [`Checkpoint::save`].
    #[cfg(not(target_family = "wasm"))]
    pub fn save_checkpoint(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.checkpoint()?.save(path)
    }

    /// Goes on from a checkpoint: with the same options on the same device, in the same bits as if it had never stopped.
    /// Of the [`Report`](crate::Report) alone `replays` and `list_builds` may differ, for lists are made anew.
    ///
    /// # Errors
    /// As for [`Simulation::with_options`]; among them [`Error::NoAdapter`] for one that ran on a GPU where there is none.
    #[cfg(not(target_family = "wasm"))]
    pub fn resume(checkpoint: Checkpoint) -> Result<Self> {
        engine::block_on(None, Self::resume_async(checkpoint))
    }

    /// [`Simulation::resume`] without blocking.
    ///
    /// # Errors
    /// As there.
    pub async fn resume_async(checkpoint: Checkpoint) -> Result<Self> {
        let world = prepare(&checkpoint.scene, &checkpoint.options)?;
        let (engine, info) = Engine::open(&checkpoint.options, &world).await?;
        let simulation = Self::assemble(checkpoint.scene, checkpoint.options, world, engine, info);
        Ok(simulation.with_past(checkpoint.time_step, checkpoint.report, checkpoint.history))
    }

    /// [`Simulation::resume`] on the caller's wgpu device; see [`Simulation::on_device`].
    ///
    /// # Errors
    /// As there.
    #[cfg(feature = "gpu")]
    pub fn resume_on_device(checkpoint: Checkpoint, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        let simulation = Self::on_device_as_is(checkpoint.scene, checkpoint.options, device, queue)?;
        Ok(simulation.with_past(checkpoint.time_step, checkpoint.report, checkpoint.history))
    }

    fn with_past(mut self, time_step: f32, report: crate::Report, history: History) -> Self {
        self.time_step = time_step;
        self.report = report;
        self.disorder = Disorder::sorted_at(report.steps);
        self.status.lengths_due = u32::from(history.lengths_due);
        self.world.step.margin_scale = history.margin_scale;
        self.world.step.lookahead = history.lookahead;
        self.lookahead = Lookahead::from_steps(history.lookahead);
        self
    }
}
