//! Measures the time of every stage, the size of the buffers and the bandwidth of the memory.

use std::mem::size_of_val;

use crate::error::Result;
use crate::exec::cpu::Watch;
use crate::model::buffer::Buffer;
use crate::model::world::World;
use crate::profile::{BufferSize, Clock, Profile, Recorder};
use crate::simulation::Simulation;
#[cfg(not(target_family = "wasm"))]
use crate::simulation::engine;

impl Simulation {
    /// [`Simulation::run`] with every stage timed: on the GPU by timestamps around every dispatch, on the CPU by the host's
    /// clock.
    ///
    /// The steps are the same as those of `run`, but slower, so measure throughput with `run`. The difference is largest in
    /// small scenes on a GPU, where `run` computes many stages in one dispatch and this method runs them one by one.
    ///
    /// # Errors
    /// As for [`Simulation::run`], and [`Error::Device`](crate::Error::Device), before any step, when the GPU has no timestamps
    /// or was opened without them (see [`Simulation::clock`]).
    #[cfg(not(target_family = "wasm"))]
    pub fn profile(&mut self, steps: u64, dt: f32) -> Result<Profile> {
        let device = self.engine.waiter();
        engine::block_on(device, self.profile_async(steps, dt))
    }

    /// [`Simulation::profile`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::profile`].
    pub async fn profile_async(&mut self, steps: u64, dt: f32) -> Result<Profile> {
        let clock = self.clock()?;
        let before = self.report.steps;
        let mut recorder = Recorder::default();
        let wall = Watch::start();
        self.run_recorded(steps, dt, Some(&mut recorder)).await?;
        Ok(Profile {
            stages: recorder.stages,
            seconds: wall.seconds(),
            steps: self.report.steps - before,
            rejected_seconds: recorder.rejected_seconds,
            clock,
        })
    }

    /// The clock that [`Simulation::profile`] times stages with.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the GPU has no timestamps or was opened without them.
    pub fn clock(&self) -> Result<Clock> {
        #[cfg(feature = "gpu")]
        if let Some(world) = self.engine.gpu_world() {
            return crate::exec::gpu::clock(world.gpu());
        }
        Ok(Clock::Host)
    }

    /// Total size in bytes of all buffers of the simulation on the device; on the CPU backend, of its arrays.
    pub fn device_memory(&self) -> u64 {
        self.buffer_sizes().iter().map(|buffer| buffer.bytes).sum()
    }

    /// Size of every buffer on the device; on the CPU backend, of every array.
    pub fn buffer_sizes(&self) -> Vec<BufferSize> {
        #[cfg(feature = "gpu")]
        if let Some(world) = self.engine.gpu_world() {
            return world.buffer_sizes();
        }
        array_sizes(&self.world)
    }

    /// Measures the bandwidth of a plain copy of a large buffer on the device, or on the CPU backend of a large array on all
    /// threads. Returns bytes read plus bytes written per second, the best of several copies. Temporarily allocates up to 1
    /// GiB.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when there is not enough memory, or the GPU has no timestamps.
    #[cfg(not(target_family = "wasm"))]
    pub fn copy_bandwidth(&self) -> Result<f64> {
        let device = self.engine.waiter();
        engine::block_on(device, self.copy_bandwidth_async())
    }

    /// [`Simulation::copy_bandwidth`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::copy_bandwidth`].
    pub async fn copy_bandwidth_async(&self) -> Result<f64> {
        #[cfg(feature = "gpu")]
        if let Some(world) = self.engine.gpu_world() {
            return crate::exec::gpu::copy_bandwidth(world.gpu()).await;
        }
        Ok(host_copy_bandwidth())
    }
}

fn array_sizes(world: &World) -> Vec<BufferSize> {
    let arrays = Buffer::ALL.into_iter().filter(|buffer| *buffer != Buffer::Status);
    arrays.map(|buffer| BufferSize::new(buffer.label(), world.bytes(buffer).len() as u64)).collect()
}

/// Measures the bandwidth of a copy on all threads, piece by piece, in bytes per second.
fn host_copy_bandwidth() -> f64 {
    use rayon::prelude::*;
    // Much larger than any cache.
    const WORDS: usize = 32 << 20;
    const PIECE: usize = 1 << 16;
    const COPIES: u32 = 5;
    let source = vec![1_u64; WORDS];
    let mut copied = vec![0_u64; WORDS];
    let mut best = f64::INFINITY;
    for _ in 0..COPIES {
        let watch = Watch::start();
        let pieces = copied.par_chunks_mut(PIECE).zip(source.par_chunks(PIECE));
        pieces.for_each(|(to, from)| to.copy_from_slice(from));
        best = best.min(watch.seconds());
    }
    2.0 * size_of_val(&source[..]) as f64 / best
}
