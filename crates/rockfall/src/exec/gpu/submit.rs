//! Compiles, binds, records and submits stages.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::bytes_of;
#[cfg(not(target_family = "wasm"))]
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::kernel::Kernel;
use crate::exec::gpu::memory::{READ_BACK, UNIFORM, make_buffer};
use crate::exec::gpu::split::binding_numbers;
use crate::exec::gpu::timer::Timer;
use crate::exec::gpu::wait::Mapped;
use crate::exec::gpu::world::GpuWorld;
use crate::model::buffer::Buffer;
use crate::model::dispatch::rows;
use crate::model::layout::{SWEEPS_FEW, SWEEPS_ON};
use crate::model::status::Status;
use crate::model::step::{Constants, Pass, Step};
use crate::step::collisions::sweep_at_once;
use crate::step::schedule::Run;
use crate::step::wgsl::Variant;

impl GpuWorld {
    /// The uniform block `pass_` of a pass, created at its first use.
    fn pass_block(&mut self, index: u32) -> Result<wgpu::Buffer> {
        if let Some(known) = self.passes.get(&index) {
            return Ok(known.clone());
        }
        let made = make_buffer(self.gpu().device(), "pass", size_of::<Pass>() as u64, UNIFORM)?;
        let block = Pass { index, ..Default::default() };
        catch(self.gpu().device(), || self.gpu().queue().write_buffer(&made, 0, bytes_of(&block)))?;
        self.passes.insert(index, made.clone());
        Ok(made)
    }

    fn make_group(&self, run: &Run, block: &wgpu::Buffer, chunks: &[u32], layout: &wgpu::BindGroupLayout) -> wgpu::BindGroup {
        let Run { stage, pass, .. } = *run;
        let mut entries = vec![
            wgpu::BindGroupEntry { binding: 0, resource: self.uniform.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: block.as_entire_binding() },
        ];
        for (binding, numbers) in stage.bindings.iter().zip(binding_numbers(chunks)) {
            let buffers = self.chunks(binding.slot.buffer(pass)).iter().zip(numbers);
            entries.extend(
                buffers.map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }),
            );
        }
        self.gpu().device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some(stage.name), layout, entries: &entries })
    }

    /// Compiles and binds the kernels that are missing. [`GpuWorld::run`] does so by itself. Calling this first avoids the wait
    /// there.
    ///
    /// # Errors
    /// [`Error::Device`] with the compiler's message and the position in the file of the stage.
    pub fn prepare(&mut self, runs: &[Run]) -> Result<()> {
        // Kernels of other stages would only cost compile time.
        let step = *self.step();
        let is_missing = |run: &&Run| run.applies(&step) && !self.ready.contains_key(&(run.stage.name, run.pass));
        let missing: Vec<&Run> = runs.iter().filter(is_missing).collect();
        if missing.is_empty() {
            // Threads that compile nothing would still be woken up.
            return Ok(());
        }
        for (run, (kernel, chunks)) in missing.iter().zip(self.compile(&missing, Variant::of(&step))?) {
            let block = self.pass_block(run.pass)?;
            let group = catch(self.gpu().device(), || self.make_group(run, &block, &chunks, &kernel.layout))?;
            self.ready.insert((run.stage.name, run.pass), (kernel, group));
        }
        Ok(())
    }

    /// Compiles the kernels of runs, several at a time. Returns each with the number of chunks of each of its arrays.
    fn compile(&self, runs: &[&Run], variant: Variant) -> Result<Vec<(Arc<Kernel>, Vec<u32>)>> {
        let of = |run: &&Run| {
            let slots = run.stage.bindings.iter().map(|binding| binding.slot.buffer(run.pass));
            let chunks: Vec<u32> = slots.map(|buffer| self.chunks(buffer).len() as u32).collect();
            Ok((self.gpu().kernel(run.stage, variant, chunks.clone(), &self.laws)?, chunks))
        };
        #[cfg(not(target_family = "wasm"))]
        return runs.par_iter().map(of).collect();
        // A device of a browser belongs to one thread.
        #[cfg(target_family = "wasm")]
        runs.iter().map(of).collect()
    }

    /// Records the stages of `steps` into a compute pass. The numbers of the steps are those of [`Run::is_in`].
    /// [`GpuWorld::prepare`] must have been called for the stages.
    ///
    /// # Errors
    /// [`Error::Device`] for a stage that was not prepared.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>, runs: &[Run], steps: Range<u32>) -> Result<()> {
        let across = self.gpu().device().limits().max_compute_workgroups_per_dimension;
        let mut table = Vec::with_capacity(runs.len());
        for run in runs {
            let groups = run.workgroups(self.step());
            if groups == 0 {
                continue;
            }
            let Some((kernel, group)) = self.ready.get(&(run.stage.name, run.pass)) else {
                return Err(Error::Device(format!("stage {} was not prepared", run.stage.name)));
            };
            table.push((run, kernel, group, rows(groups, across)));
        }
        for step in steps {
            for (_, kernel, group, [x, y, z]) in table.iter().filter(|(run, ..)| run.is_in(step)) {
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, *group, &[]);
                pass.dispatch_workgroups(*x, *y, *z);
            }
        }
        Ok(())
    }

    /// Runs a list of stages `steps` times in one submission, with the constants of `step`. Does not wait.
    ///
    /// # Errors
    /// [`Error::Device`] when a kernel does not compile, or the device is lost or reports an error. The loss of a device may
    /// not be reported before data is read back.
    pub fn run(&mut self, runs: &[Run], step: &Step, steps: u32) -> Result<()> {
        self.submit_plain(runs, step, 0..steps, None).map(drop)
    }

    /// Like [`GpuWorld::run`], for steps numbered as in [`Run::is_in`]. The status after them is sent to the host.
    pub(crate) fn run_and_read_status(&mut self, runs: &[Run], step: &Step, steps: Range<u32>) -> Result<Mapped> {
        let staging = make_buffer(self.gpu().device(), "status", size_of::<Status>() as u64, READ_BACK)?;
        let submission = self.submit_plain(runs, step, steps, Some(&staging))?;
        Ok(Mapped::read(&staging, self.gpu().faults()).after(submission))
    }

    fn submit_plain(
        &mut self,
        runs: &[Run],
        step: &Step,
        steps: Range<u32>,
        staging: Option<&wgpu::Buffer>,
    ) -> Result<wgpu::SubmissionIndex> {
        self.write_uniforms(step)?;
        self.submit(runs, step, steps, staging, None)
    }

    /// Like [`GpuWorld::prepare`], for the dispatches of runs without timestamps, also of those that run only once several
    /// collisions share a body.
    pub(crate) fn prepare_plain(&mut self, runs: &[Run]) -> Result<()> {
        let present = self.step.constants;
        for wanted in [SWEEPS_FEW, SWEEPS_ON] {
            if wanted > present.sweeps && (wanted == SWEEPS_ON || sweep_at_once::fits(&self.step.traits())) {
                self.step.constants = Constants { sweeps: wanted, ..present };
                let prepared = self.prepare(runs);
                self.step.constants = present;
                prepared?;
            }
        }
        self.prepare(runs)
    }

    /// Like [`GpuWorld::run`], for steps numbered as in [`Run::is_in`], with every dispatch timed.
    ///
    /// # Errors
    /// As for [`GpuWorld::run`], and [`Error::Device`] when the device has no timestamps.
    pub(crate) fn run_timed(&mut self, runs: &[Run], step: &Step, steps: Range<u32>) -> Result<Timer> {
        // The uniforms must be written first, because they determine which runs have work to do.
        self.write_uniforms(step)?;
        let timer = Timer::new(self, runs, steps.clone())?;
        self.submit(runs, step, steps, None, Some(&timer))?;
        Ok(timer)
    }

    fn encode_pass(&self, encoder: &mut wgpu::CommandEncoder, runs: &[Run], steps: Range<u32>) -> Result<()> {
        let of_steps = wgpu::ComputePassDescriptor { label: Some("steps"), timestamp_writes: None };
        self.encode(&mut encoder.begin_compute_pass(&of_steps), runs, steps)
    }

    fn submit(
        &mut self,
        runs: &[Run],
        step: &Step,
        steps: Range<u32>,
        staging: Option<&wgpu::Buffer>,
        timer: Option<&Timer>,
    ) -> Result<wgpu::SubmissionIndex> {
        self.gpu().faults().check()?;
        self.write_uniforms(step)?;
        self.prepare(runs)?;
        let dispatched = |at: u32| runs.iter().filter(|run| run.is_in(at) && !self.is_idle(run)).count() as u64;
        let dispatches = steps.clone().map(dispatched).sum::<u64>();
        self.dispatches += dispatches;
        let gpu = self.gpu().clone();
        let submission = catch(gpu.device(), || {
            let new_encoder = || gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("steps") });
            let mut encoder = new_encoder();
            if let Some(timer) = timer {
                timer.encode(&mut encoder, self, runs)?;
            } else {
                let (early, others) = runs.split_at(self.early_runs(runs, &steps));
                if !early.is_empty() {
                    self.encode_pass(&mut encoder, early, steps.clone())?;
                    self.submit_early(std::mem::replace(&mut encoder, new_encoder()))?;
                }
                self.encode_pass(&mut encoder, others, steps)?;
            }
            if let Some(staging) = staging {
                let status = &self.chunks(Buffer::Status)[0];
                encoder.copy_buffer_to_buffer(status, 0, staging, 0, staging.size());
            }
            Ok::<_, Error>(gpu.queue().submit([encoder.finish()]))
        })??;
        self.gpu().faults().check()?;
        Ok(submission)
    }
}
