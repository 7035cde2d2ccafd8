//! Many small worlds on a device, in workgroups of one or a few.

use bytemuck::{Zeroable, bytes_of, cast_slice};
use glam::Vec4;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::exec::gpu::check::check_buffer;
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, UNIFORM, make_buffer};
use crate::exec::gpu::wait::{Mapped, block_on};
use crate::exec::gpu::world_lengths::LengthWriter;
pub(crate) use crate::exec::gpu::world_lengths::Lengths;
use crate::model::buffer::Buffer;
use crate::model::dispatch::rows;
use crate::model::layout::{
    BOX_WORDS, KIND_SHIFT, KIND_SPRING, LAW_THESIS, MUSCLE_WORDS, POLYGON_WORDS, SPRING_WORDS, STEPS_SHIFT, SYMPLECTIC_EULER,
};
use crate::model::step::{Pass, Step};
use crate::model::world::World;
use crate::model::world_batch::WorldBatch;
use crate::model::world_sizes::WorldSizes;
use crate::settings::Integrator;
use crate::step::fused::run_worlds::{STAGE, WorldResult};
use crate::step::stage::Stage;
use crate::step::wgsl::Variant;

/// Most steps of a dispatch. Systems stop dispatches that take seconds.
const MOST_STEPS: u64 = 1000;
/// Places of the buffers that are read back: states, orientations, results.
const READ: [usize; 3] = [1, 3, 4];

/// Worlds on a device.
#[derive(Debug)]
pub(crate) struct DeviceWorlds {
    gpu: Gpu,
    count: u32,
    batch: WorldBatch,
    buffers: [wgpu::Buffer; 5],
    /// The kernel, which tests replace.
    stage: &'static Stage,
    /// Writes rest lengths; compiled at its first use.
    lengths: Option<LengthWriter>,
    /// Memory of the host for the buffers that are read back, and that no [`Download`] uses.
    staging: Vec<[wgpu::Buffer; 3]>,
}

/// A copy of the states of all worlds that is on its way to the host.
#[derive(Debug)]
pub(crate) struct Download {
    staging: [wgpu::Buffer; 3],
    mapped: [Mapped; 3],
}

/// Bytes per world of the buffers: parameters, starts, topologies, turns, results.
fn bytes_of_world(sizes: &WorldSizes) -> [u64; 5] {
    let spheres = u64::from(sizes.spheres);
    // WGSL aligns the block of parameters to 16 bytes.
    let parameters = (size_of::<Step>() as u64).next_multiple_of(16);
    [parameters, 64 * spheres, 4 * u64::from(sizes.topology), 16 * spheres, size_of::<WorldResult>() as u64]
}

/// The states of all worlds, as they are on the device.
#[derive(Debug)]
pub(crate) struct States<'a> {
    spheres: usize,
    starts: &'a [[f32; 4]],
    turns: &'a [[f32; 4]],
    results: &'a [WorldResult],
}

impl DeviceWorlds {
    /// Room for `count` worlds of up to these sizes, which must be uploaded before they run.
    pub(crate) fn new(gpu: &Gpu, count: u32, sizes: WorldSizes) -> Result<Self> {
        gpu.check_limits()?;
        let limits = gpu.device().limits();
        let labels = ["parameters of worlds", "states of worlds", "topologies of worlds", "orientations of worlds", "results"];
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        for (what, bytes) in labels.into_iter().zip(bytes_of_world(&sizes)) {
            let needed = bytes * u64::from(count);
            if needed > most {
                return Err(Error::DeviceLimit { what, needed, limit: most });
            }
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let mut made = Vec::new();
        for (label, bytes) in labels.into_iter().zip(bytes_of_world(&sizes)) {
            made.push(make_buffer(gpu.device(), label, bytes * u64::from(count.max(1)), usage)?);
        }
        let buffers = std::array::from_fn(|place| made[place].clone());
        let batch = WorldBatch::new(sizes, count);
        Ok(Self { gpu: gpu.clone(), count, batch, buffers, stage: &STAGE, lengths: None, staging: Vec::new() })
    }

    pub(crate) fn sizes(&self) -> WorldSizes {
        self.batch.sizes
    }

    /// Sets whether small worlds share workgroups.
    pub(crate) fn share_workgroups(&mut self, shared: bool) {
        self.batch.shared = shared;
    }

    /// Replaces the kernel.
    pub(crate) fn set_kernel(&mut self, stage: &'static Stage) {
        self.stage = stage;
    }

    /// What a world needs if there is room for it.
    pub(crate) fn fits(&self, world: &World) -> Option<WorldSizes> {
        WorldSizes::of(world).filter(|sizes| self.batch.sizes.holds(sizes))
    }

    /// From now on, the kernel has code for pairs of spheres.
    pub(crate) fn allow_pairs(&mut self) {
        self.batch.sizes.pairs = true;
    }

    /// Writes neighbouring worlds, for which there is room, to the slots from `first` on. `pack` returns the arrays of a world,
    /// `calm` its number of steps without motion.
    pub(crate) fn upload<W: Send>(
        &self,
        first: u32,
        worlds: &mut [W],
        pack: impl Fn(&mut W) -> Result<&World> + Sync,
        calm: impl Fn(&W) -> u32 + Sync,
    ) -> Result<()> {
        let bytes = bytes_of_world(&self.batch.sizes);
        let mut pieces = bytes.map(|bytes| vec![0; bytes as usize * worlds.len()]);
        let [steps, starts, topologies, turns, results] = &mut pieces;
        let places = (
            steps.par_chunks_mut(bytes[0] as usize),
            starts.par_chunks_mut(bytes[1] as usize),
            topologies.par_chunks_mut(bytes[2] as usize),
            turns.par_chunks_mut(bytes[3] as usize),
            results.par_chunks_mut(bytes[4] as usize),
        );
        worlds.par_iter_mut().zip(places.into_par_iter()).try_for_each(
            |(world, (step, starts, topology, turns, result))| {
                let reported = WorldResult { calm: calm(world), ..WorldResult::START };
                let world = pack(world)?;
                for buffer in [Buffer::Start, Buffer::Topology, Buffer::Orientations] {
                    check_buffer(world, buffer)?;
                }
                let rows = world.step.layout.spheres as usize;
                let room = starts.len() / 4;
                for region in 0..4 {
                    put(&mut starts[region * room..], cast_slice(&world.states[0][region * rows..][..rows]));
                }
                put(step, bytes_of(&world.step));
                put(topology, cast_slice(&kernel_topology(world)));
                put(turns, cast_slice(&world.orientations));
                put(result, bytes_of(&reported));
                Ok(())
            },
        )?;
        catch(self.gpu.device(), || {
            for ((buffer, bytes), piece) in self.buffers.iter().zip(bytes).zip(&pieces) {
                self.gpu.queue().write_buffer(buffer, u64::from(first) * bytes, piece);
            }
        })
    }

    /// Writes rest lengths of worlds that were uploaded, and wakes these up.
    pub(crate) fn write_lengths(&mut self, lengths: &Lengths) -> Result<()> {
        let mut writer = match self.lengths.take() {
            Some(writer) => writer,
            None => LengthWriter::new(&self.gpu)?,
        };
        let [_, _, topologies, _, results] = &self.buffers;
        let written = writer.write(&self.gpu, lengths, self.batch.sizes.topology, [topologies, results]);
        self.lengths = Some(writer);
        written
    }

    /// Advances all worlds. `rest` are the steps without motion after which a world stands still, or 0, and the greatest speed at rest.
    pub(crate) fn run(&self, steps: u64, integrator: Integrator, rest: (u32, f32)) -> Result<()> {
        if self.count == 0 {
            return Ok(());
        }
        let variant = Variant {
            rods: false,
            large: false,
            muscles: false,
            walls: false,
            rigid: false,
            passages: false,
            triangles: false,
            smooth: false,
            sheared: false,
            rod_polygons: false,
            periodic: false,
            law: LAW_THESIS,
            materials: false,
            resistance: false,
            cohesion: false,
            verlet: false,
            half_step: false,
            free_table: false,
            double: false,
            residues: false,
            continuous: false,
            many: false,
            worlds: Some(self.batch),
        };
        let kernel = self.gpu.kernel(self.stage, variant, vec![1; self.stage.bindings.len()], &std::sync::Arc::default())?;
        let device = self.gpu.device();
        let across = device.limits().max_compute_workgroups_per_dimension;
        let [x, y, z] = rows(self.count.div_ceil(self.batch.group().0), across);
        let euler = if integrator == Integrator::SymplecticEuler { SYMPLECTIC_EULER } else { 0 };
        let mut left = steps;
        while left > 0 {
            let portion = left.min(MOST_STEPS);
            let block = make_buffer(device, "pass", size_of::<Pass>() as u64, UNIFORM)?;
            let index = (portion as u32) << STEPS_SHIFT | euler;
            let pass = Pass { index, rest_steps: rest.0, rest_speed: rest.1, ..Pass::zeroed() };
            catch(device, || {
                self.gpu.queue().write_buffer(&block, 0, bytes_of(&pass));
                let resource = |number: u32| match number {
                    // The kernel does not use binding 0.
                    0 | 1 => block.as_entire_binding(),
                    _ => self.buffers[number as usize - 2].as_entire_binding(),
                };
                let entries: Vec<_> =
                    (0..7).map(|binding| wgpu::BindGroupEntry { binding, resource: resource(binding) }).collect();
                let descriptor =
                    wgpu::BindGroupDescriptor { label: Some(STAGE.name), layout: &kernel.layout, entries: &entries };
                let group = device.create_bind_group(&descriptor);
                let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("worlds") });
                {
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                    pass.set_pipeline(&kernel.pipeline);
                    pass.set_bind_group(0, &group, &[]);
                    pass.dispatch_workgroups(x, y, z);
                }
                self.gpu.queue().submit([encoder.finish()]);
            })?;
            left -= portion;
        }
        self.gpu.faults().check()
    }

    /// Waits for the device, and gives the states of all worlds to `take`.
    pub(crate) fn download<T>(&mut self, take: impl FnOnce(&States<'_>) -> T) -> Result<T> {
        let download = self.start_download()?;
        self.finish_download(download, take)
    }

    /// Starts to copy the states of all worlds, as they are after the steps that were submitted so far.
    pub(crate) fn start_download(&mut self) -> Result<Download> {
        let device = self.gpu.device();
        let sizes = bytes_of_world(&self.batch.sizes).map(|bytes| bytes * u64::from(self.count.max(1)));
        let staging = match self.staging.pop() {
            Some(staging) => staging,
            None => {
                let [starts, turns, results] =
                    READ.map(|place| make_buffer(device, "read back", sizes[place].max(4), READ_BACK));
                [starts?, turns?, results?]
            }
        };
        let submission = catch(device, || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            for (place, to) in READ.iter().zip(&staging) {
                encoder.copy_buffer_to_buffer(&self.buffers[*place], 0, to, 0, sizes[*place]);
            }
            self.gpu.queue().submit([encoder.finish()])
        })?;
        let mapped = staging.each_ref().map(|buffer| Mapped::read(buffer, self.gpu.faults()).after(submission.clone()));
        Ok(Download { staging, mapped })
    }

    /// Waits for a copy, and gives the states to `take`.
    pub(crate) fn finish_download<T>(&mut self, download: Download, take: impl FnOnce(&States<'_>) -> T) -> Result<T> {
        let mut views = Vec::with_capacity(download.mapped.len());
        for mapped in download.mapped {
            views.push(block_on(self.gpu.device(), mapped.bytes("the worlds"))?);
        }
        let [starts, turns, results] = &views[..] else { return Err(Error::Device("a state is missing".to_owned())) };
        let spheres = self.batch.sizes.spheres as usize;
        let states = States { spheres, starts: cast_slice(starts), turns: cast_slice(turns), results: cast_slice(results) };
        let taken = take(&states);
        drop(views);
        download.staging.iter().for_each(wgpu::Buffer::unmap);
        self.staging.push(download.staging);
        Ok(taken)
    }
}

/// Set in the name of a spring at its end B, as in the kernel. Indices are smaller.
const END_B: u8 = 1 << 7;
/// Names of springs in a word.
const SPRING_NAMES: usize = 4;
/// A name has 7 bits for the index, and a number of springs is stored beside an index of a word of topology with 16 bits.
const _: () = assert!(WorldSizes::MOST.springs <= END_B as u32 && WorldSizes::MOST.topology <= 1 << 16);

/// The topology of a world as the kernel reads it: names of springs in the adjacency, and records field by field.
fn kernel_topology(world: &World) -> Vec<u32> {
    let step = &world.step;
    let mut words = world.topology.clone();
    if step.layout.adjacency_at != 0 {
        (0..step.layout.spheres).for_each(|sphere| name_springs(world, sphere, &mut words));
    }
    let springs = step.spring_count();
    let muscles = if step.layout.muscles_at == 0 { 0 } else { springs };
    let tables = [
        (step.layout.boxes_at, step.layout.boxes, BOX_WORDS),
        (step.layout.polygons_at, step.layout.polygons, POLYGON_WORDS),
        (step.layout.springs_at, springs, SPRING_WORDS),
        (step.layout.muscles_at, muscles, MUSCLE_WORDS),
    ];
    for (first, count, fields) in tables.map(|(first, count, fields)| (first as usize, count as usize, fields as usize)) {
        for field in 0..fields {
            for record in 0..count {
                words[first + field * count + record] = world.topology[first + record * fields + field];
            }
        }
    }
    words
}

/// Replaces the springs in the adjacency of a sphere by their names. Its first word says how many there are.
fn name_springs(world: &World, sphere: u32, words: &mut [u32]) {
    let step = &world.step;
    let range = (step.layout.adjacency_at + 2 * sphere) as usize;
    let [first, end] = [range, range + 1].map(|at| world.topology[at] as usize);
    let is_spring = |word: &&u32| **word >> KIND_SHIFT == KIND_SPRING;
    let name = |word: &u32| {
        let index = word & ((1 << KIND_SHIFT) - 1);
        let is_end_a = world.topology[(step.layout.springs_at + index * SPRING_WORDS) as usize] == sphere;
        index as u8 | if is_end_a { 0 } else { END_B }
    };
    let names: Vec<u8> = world.topology[first..end].iter().take_while(is_spring).map(name).collect();
    words[range] |= (names.len() as u32) << 16;
    for (word, names) in words[first..].iter_mut().zip(names.chunks(SPRING_NAMES)) {
        *word = (0..).step_by(8).zip(names).map(|(shift, name)| u32::from(*name) << shift).sum();
    }
}

/// Writes bytes to the beginning of a place.
fn put(place: &mut [u8], bytes: &[u8]) {
    place[..bytes.len()].copy_from_slice(bytes);
}

impl States<'_> {
    /// What a world reported.
    pub(crate) fn result(&self, slot: usize) -> WorldResult {
        self.results[slot]
    }

    /// Position, velocity, angular momentum, low part of the position and orientation of a sphere of a world.
    pub(crate) fn sphere(&self, slot: usize, sphere: usize) -> [Vec4; 5] {
        let row = |region: usize| Vec4::from_array(self.starts[(4 * slot + region) * self.spheres + sphere]);
        [row(0), row(1), row(2), row(3), Vec4::from_array(self.turns[slot * self.spheres + sphere])]
    }

    /// Copies the state of a world into a host's world of as many spheres.
    pub(crate) fn copy_to(&self, slot: usize, world: &mut World) {
        let spheres = world.step.layout.spheres as usize;
        let copy = |to: &mut [Vec4], from: &[[f32; 4]]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = Vec4::from_array(*from));
        };
        for region in 0..4 {
            let rows = &self.starts[(4 * slot + region) * self.spheres..];
            copy(&mut world.states[0][region * spheres..][..spheres], rows);
        }
        copy(&mut world.orientations[..spheres], &self.turns[slot * self.spheres..]);
    }
}
