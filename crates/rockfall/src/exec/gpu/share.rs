//! Rows of spheres that several processes share (docs/cluster.md), between the arrays of a world and the host.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, cast_slice_mut};
use wgpu::BufferSize;
use wgpu::util::StagingBelt;

use crate::error::Result;
use crate::exec::gpu::copiers::Copiers;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, make_buffer};
use crate::exec::gpu::wait::Mapped;
use crate::exec::gpu::world::{GpuWorld, UNIFORM};
use crate::model::buffer::Buffer;
use crate::model::dispatch::rows;
use crate::model::shared::{SENT_WORDS, Shared};

/// Threads per workgroup in `share.wgsl`.
const THREADS: u32 = 256;

/// The uniform block of `share.wgsl`.
#[derive(Clone, Copy, Zeroable, Pod)]
#[repr(C)]
struct Block {
    spheres: u32,
    slots_at: u32,
    count: u32,
    is_verlet: u32,
    axis: u32,
    room: f32,
    dt: f32,
    padding: u32,
}

/// The rows of a dispatch on the device.
#[derive(Debug)]
struct Table {
    count: u32,
    block: wgpu::Buffer,
    indices: wgpu::Buffer,
    words: wgpu::Buffer,
}

/// The tables on the device of what a process shares.
#[derive(Debug)]
pub(crate) struct Link {
    kernels: Arc<Copiers>,
    sent: Table,
    received: Table,
    own: Table,
    is_far: wgpu::Buffer,
    /// Takes rows to the host.
    staging: wgpu::Buffer,
    /// Takes rows to the device.
    belt: StagingBelt,
    axis: u32,
    room: f32,
    is_verlet: bool,
}

impl Link {
    /// Makes the tables.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when memory runs out, or an array of the world is larger than one binding may be.
    pub(crate) fn new(world: &GpuWorld, shared: &Shared, is_verlet: bool) -> Result<Self> {
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let device = world.gpu().device();
        let made = |name: &str, words: usize| make_buffer(device, name, 4 * words.max(1) as u64, storage);
        let table = |indices: &[u32], width: usize| -> Result<Table> {
            let table = Table {
                count: indices.len() as u32,
                block: make_buffer(device, "shared rows", size_of::<Block>() as u64, UNIFORM)?,
                indices: made("shared spheres", indices.len())?,
                words: made("shared rows", width * indices.len())?,
            };
            catch(device, || world.gpu().queue().write_buffer(&table.indices, 0, cast_slice(indices)))?;
            Ok(table)
        };
        let own = table(&shared.own, 1)?;
        catch(device, || world.gpu().queue().write_buffer(&own.words, 0, cast_slice(&shared.starts)))?;
        let sent = table(&shared.sent.concat(), SENT_WORDS)?;
        let staging = make_buffer(device, "shared rows", sent.words.size() + 4, READ_BACK)?;
        let received = table(&shared.received.concat(), SENT_WORDS)?;
        let (axis, room) = (shared.axis as u32, shared.room as f32);
        let kernels = world.gpu().sharers()?;
        let belt = StagingBelt::new(device.clone(), received.words.size());
        Ok(Self { kernels, sent, received, own, is_far: made("far", 1)?, staging, belt, axis, room, is_verlet })
    }

    /// Reads the rows that are sent to each process. Returns whether some own sphere may leave its room in a step of `dt` seconds.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) async fn take(&self, world: &GpuWorld, dt: f32, to: &mut [Vec<u32>]) -> Result<bool> {
        let (device, queue) = (world.gpu().device(), world.gpu().queue());
        let mut encoder = world.encoder();
        catch(device, || queue.write_buffer(&self.is_far, 0, &[0; 4]))?;
        self.encode(world, &mut encoder, &self.sent, "take", dt)?;
        self.encode(world, &mut encoder, &self.own, "look", dt)?;
        let size = self.sent.words.size();
        let submission = catch(device, || {
            encoder.copy_buffer_to_buffer(&self.sent.words, 0, &self.staging, 0, size);
            encoder.copy_buffer_to_buffer(&self.is_far, 0, &self.staging, size, 4);
            queue.submit([encoder.finish()])
        })?;
        let mapped = Mapped::read(&self.staging, world.gpu().faults()).after(submission);
        let view = mapped.bytes("shared rows").await?;
        let mut at = 0;
        for message in to {
            let bytes: &mut [u8] = cast_slice_mut(message);
            bytes.copy_from_slice(&view[at..at + bytes.len()]);
            at += bytes.len();
        }
        let is_far = view[size as usize] != 0;
        drop(view);
        self.staging.unmap();
        Ok(is_far)
    }

    /// Writes the rows that were received. Submits this without waiting for it.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) fn put(&mut self, world: &GpuWorld, from: &[Vec<u32>]) -> Result<()> {
        let (device, queue) = (world.gpu().device(), world.gpu().queue());
        let mut encoder = world.encoder();
        catch(device, || {
            let mut at = 0;
            for bytes in from.iter().map(|words| cast_slice::<u32, u8>(words)) {
                if let Some(size) = BufferSize::new(bytes.len() as u64) {
                    let mut view = self.belt.write_buffer(&mut encoder, &self.received.words, at, size);
                    view.copy_from_slice(bytes);
                    at += size.get();
                }
            }
            self.belt.finish();
        })?;
        self.encode(world, &mut encoder, &self.received, "put", 0.0)?;
        catch(device, || queue.submit([encoder.finish()]))?;
        self.belt.recall();
        Ok(())
    }

    fn encode(
        &self,
        world: &GpuWorld,
        encoder: &mut wgpu::CommandEncoder,
        table: &Table,
        entry_point: &str,
        dt: f32,
    ) -> Result<()> {
        if table.count == 0 {
            return Ok(());
        }
        let (gpu, layout) = (world.gpu(), &world.step().layout);
        let Self { axis, room, is_verlet, .. } = *self;
        let (spheres, slots_at) = (layout.spheres, layout.slots_at);
        let block =
            Block { spheres, slots_at, count: table.count, is_verlet: u32::from(is_verlet), axis, room, dt, padding: 0 };
        let arrays = [Buffer::Start, Buffer::Topology, Buffer::Rates].map(|array| world.buffer(array));
        let [state, topology, rates] = arrays;
        let buffers = [&table.block, state?, topology?, rates?, &table.indices, &table.words, &self.is_far];
        let across = gpu.device().limits().max_compute_workgroups_per_dimension;
        catch(gpu.device(), || {
            gpu.queue().write_buffer(&table.block, 0, bytes_of(&block));
            let group = self.kernels.bind(gpu.device(), &buffers);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            self.kernels.dispatch(&mut pass, entry_point, &group, rows(table.count.div_ceil(THREADS), across));
        })
    }
}
