//! Many small worlds on a device, one workgroup each.

use bytemuck::{Zeroable, bytes_of, cast_slice};
use glam::Vec4;

use crate::error::Result;
use crate::exec::gpu::check::check_buffer;
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, make_buffer};
use crate::exec::gpu::wait::{Mapped, block_on};
use crate::exec::gpu::world::UNIFORM;
use crate::model::buffer::Buffer;
use crate::model::dispatch::rows;
use crate::model::layout::{LAW_THESIS, PHASES_SHIFT, SYMPLECTIC_EULER};
use crate::model::step::{Pass, Step};
use crate::model::world::World;
use crate::model::world_sizes::WorldSizes;
use crate::settings::Integrator;
use crate::step::fused::run_worlds::{STAGE, WorldResult};
use crate::step::wgsl::Variant;

/// Most steps of a dispatch. Systems stop dispatches that take seconds.
const MOST_STEPS: u64 = 1000;
/// Places of buffers that are read back.
const STARTS: usize = 1;
const TURNS: usize = 3;
const RESULTS: usize = 4;

/// Worlds on a device.
#[derive(Debug)]
pub(crate) struct DeviceWorlds {
    gpu: Gpu,
    count: u32,
    sizes: WorldSizes,
    buffers: [wgpu::Buffer; 5],
}

/// Bytes per world of the buffers: parameters, starts, topologies, turns, results.
fn bytes_of_world(sizes: &WorldSizes) -> [u64; 5] {
    let spheres = u64::from(sizes.spheres);
    // WGSL aligns the block of parameters to 16 bytes.
    let parameters = (size_of::<Step>() as u64).next_multiple_of(16);
    [parameters, 48 * spheres, 4 * u64::from(sizes.topology), 16 * spheres, size_of::<WorldResult>() as u64]
}

/// The states of all worlds, as they are on the device.
pub(crate) struct States {
    sizes: WorldSizes,
    starts: Vec<Vec4>,
    turns: Vec<Vec4>,
    pub(crate) results: Vec<WorldResult>,
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
                return Err(crate::Error::DeviceLimit { what, needed, limit: most });
            }
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let mut made = Vec::new();
        for (label, bytes) in labels.into_iter().zip(bytes_of_world(&sizes)) {
            made.push(make_buffer(gpu.device(), label, bytes * u64::from(count.max(1)), usage)?);
        }
        let buffers = std::array::from_fn(|place| made[place].clone());
        Ok(Self { gpu: gpu.clone(), count, sizes, buffers })
    }

    /// Whether there is room for a world.
    pub(crate) fn fits(&self, world: &World) -> bool {
        WorldSizes::of(world).is_some_and(|sizes| self.sizes.holds(&sizes))
    }

    /// Writes a world for which there is room to its slot.
    pub(crate) fn upload(&self, slot: u32, world: &World) -> Result<()> {
        for buffer in [Buffer::Start, Buffer::Topology, Buffer::Orientations] {
            check_buffer(world, buffer)?;
        }
        let (spheres, room) = (world.step.spheres as usize, self.sizes.spheres as usize);
        let mut starts = vec![Vec4::ZERO; 3 * room];
        for region in 0..3 {
            let rows = &world.states[0][region * spheres..][..spheres];
            starts[region * room..][..spheres].copy_from_slice(rows);
        }
        let pieces: [&[u8]; 5] = [
            bytes_of(&world.step),
            cast_slice(&starts),
            cast_slice(&world.topology),
            cast_slice(&world.orientations),
            bytes_of(&WorldResult::START),
        ];
        catch(self.gpu.device(), || {
            for ((buffer, bytes), piece) in self.buffers.iter().zip(bytes_of_world(&self.sizes)).zip(pieces) {
                self.gpu.queue().write_buffer(buffer, u64::from(slot) * bytes, piece);
            }
        })
    }

    /// Advances all worlds.
    pub(crate) fn run(&self, steps: u64, integrator: Integrator) -> Result<()> {
        if self.count == 0 {
            return Ok(());
        }
        let variant = Variant {
            rods: false,
            large: false,
            muscles: false,
            law: LAW_THESIS,
            materials: false,
            resistance: false,
            cohesion: false,
            many: false,
            worlds: Some(self.sizes),
        };
        let kernel = self.gpu.kernel(&STAGE, variant, vec![1; STAGE.bindings.len()])?;
        let device = self.gpu.device();
        let across = device.limits().max_compute_workgroups_per_dimension;
        let [x, y, z] = rows(self.count, across);
        let euler = if integrator == Integrator::SymplecticEuler { SYMPLECTIC_EULER } else { 0 };
        let mut left = steps;
        while left > 0 {
            let portion = left.min(MOST_STEPS);
            let block = make_buffer(device, "pass", size_of::<Pass>() as u64, UNIFORM)?;
            let pass = Pass { index: (portion as u32) << PHASES_SHIFT | euler, ..Pass::zeroed() };
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

    /// Waits for the device and reads all worlds back.
    pub(crate) fn download(&self) -> Result<States> {
        Ok(States { sizes: self.sizes, starts: self.read(STARTS)?, turns: self.read(TURNS)?, results: self.read(RESULTS)? })
    }

    fn read<T: bytemuck::Pod>(&self, place: usize) -> Result<Vec<T>> {
        let device = self.gpu.device();
        let (buffer, size) = (&self.buffers[place], bytes_of_world(&self.sizes)[place] * u64::from(self.count));
        if size == 0 {
            return Ok(Vec::new());
        }
        let staging = make_buffer(device, "read back", size, READ_BACK)?;
        catch(device, || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
            self.gpu.queue().submit([encoder.finish()]);
        })?;
        let bytes = block_on(device, Mapped::read(&staging, self.gpu.faults()).bytes("the worlds"))?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

impl States {
    /// Copies the state of a world into a host's world of as many spheres.
    pub(crate) fn copy_to(&self, slot: usize, world: &mut World) {
        let (spheres, room) = (world.step.spheres as usize, self.sizes.spheres as usize);
        for region in 0..3 {
            let rows = &self.starts[(3 * slot + region) * room..][..spheres];
            world.states[0][region * spheres..][..spheres].copy_from_slice(rows);
        }
        world.orientations.copy_from_slice(&self.turns[slot * room..][..spheres]);
    }
}
