//! Writes rest lengths to many worlds on a device. All that a world begins with has many times as many bytes.

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::kernel::layout_entry;
use crate::exec::gpu::memory::{UNIFORM, make_buffer};
use crate::model::dispatch::rows;
use crate::model::layout::{LENGTH_WORD, SPRING_WORDS};
use crate::model::world::World;
use crate::step::fused::run_worlds::WorldResult;

/// Threads per workgroup, and words of a row before the lengths, in `world_lengths.wgsl`.
const THREADS: u32 = 256;
const HEAD: usize = 3;
/// `RESULT` and `CALM` in `world_lengths.wgsl`, in words.
const _: () = assert!(size_of::<WorldResult>() == 4 * 8 && offset_of!(WorldResult, calm) == 4 * 7);

/// The uniform block of `world_lengths.wgsl`.
#[derive(Clone, Copy, Zeroable, Pod)]
#[repr(C)]
struct Sizes {
    rows: u32,
    width: u32,
    topology: u32,
    padding: u32,
}

/// The rest lengths of some worlds, in rows with room for `springs` of them.
#[derive(Debug)]
pub(crate) struct Lengths {
    springs: usize,
    words: Vec<u32>,
}

impl Lengths {
    /// The lengths that these worlds have on the host, given by slot.
    pub(crate) fn of<'a>(springs: u32, slots: &[usize], world: impl Fn(usize) -> &'a World + Sync) -> Self {
        // The kernel has a thread for every place of a row, and the thread of the first place wakes the world. So a row has at
        // least one place, even if its world has no springs.
        let springs = springs.max(1) as usize;
        let width = HEAD + springs;
        let mut words = vec![0; width * slots.len()];
        words.par_chunks_exact_mut(width).zip(slots).for_each(|(row, slot)| put_row(row, *slot as u32, world(*slot)));
        Self { springs, words }
    }
}

fn put_row(row: &mut [u32], slot: u32, world: &World) {
    let (at, count) = (world.step.layout.springs_at, world.step.spring_count());
    // The kernel has the records field by field.
    row[..HEAD].copy_from_slice(&[slot, at + LENGTH_WORD as u32 * count, count]);
    let records = world.topology[at as usize..].chunks_exact(SPRING_WORDS as usize).take(count as usize);
    row[HEAD..].iter_mut().zip(records).for_each(|(word, spring)| *word = spring[LENGTH_WORD]);
}

/// The compiled kernel.
#[derive(Debug)]
pub(crate) struct LengthWriter {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    /// The last write.
    previous: Option<wgpu::SubmissionIndex>,
}

impl LengthWriter {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        catch(gpu.device(), || Self::build(gpu.device()))
    }

    fn build(device: &wgpu::Device) -> Self {
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let kinds = [wgpu::BufferBindingType::Uniform, storage(true), storage(false), storage(false)];
        let entries: Vec<_> = (0..).zip(kinds).map(|(binding, kind)| layout_entry(binding, kind)).collect();
        let label = Some("rest lengths of worlds");
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::include_wgsl!("world_lengths.wgsl"));
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("write_lengths"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { layout, pipeline, previous: None }
    }

    /// Writes lengths to `topologies`, which has `words` words per world, and wakes the worlds up in `results`. Waits for the previous
    /// write, so that a program that never reads a state is at most two runs ahead of the device.
    pub(crate) fn write(
        &mut self,
        gpu: &Gpu,
        lengths: &Lengths,
        words: u32,
        [topologies, results]: [&wgpu::Buffer; 2],
    ) -> Result<()> {
        if let Some(previous) = self.previous.take() {
            let until = wgpu::PollType::Wait { submission_index: Some(previous), timeout: None };
            gpu.device().poll(until).map_err(|error| Error::Device(format!("waiting for the device failed: {error}")))?;
        }
        let width = HEAD + lengths.springs;
        let count = (lengths.words.len() / width) as u32;
        let (device, queue) = (gpu.device(), gpu.queue());
        let sizes = Sizes { rows: count, width: width as u32, topology: words, padding: 0 };
        let uniform = make_buffer(device, "rest lengths", size_of::<Sizes>() as u64, UNIFORM)?;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let table = make_buffer(device, "rest lengths", 4 * lengths.words.len() as u64, usage)?;
        let across = device.limits().max_compute_workgroups_per_dimension;
        let written = catch(device, || {
            queue.write_buffer(&uniform, 0, bytes_of(&sizes));
            queue.write_buffer(&table, 0, cast_slice(&lengths.words));
            let entries: Vec<_> = (0..)
                .zip([&uniform, &table, topologies, results])
                .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
                .collect();
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries };
            let group = device.create_bind_group(&descriptor);
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &group, &[]);
                let [x, y, z] = rows((count * lengths.springs as u32).div_ceil(THREADS), across);
                pass.dispatch_workgroups(x, y, z);
            }
            queue.submit([encoder.finish()])
        })?;
        self.previous = Some(written);
        Ok(())
    }
}
