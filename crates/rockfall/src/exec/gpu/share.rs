//! Rows of spheres that several processes share (docs/cluster.md), between the arrays of a world and the host.

use std::future::poll_fn;
use std::mem::offset_of;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::Poll;

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, cast_slice_mut};
use wgpu::BufferSize;
use wgpu::util::StagingBelt;

use crate::error::Result;
use crate::exec::gpu::copiers::Copiers;
use crate::exec::gpu::device::Gpu;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, UNIFORM, make_buffer};
use crate::exec::gpu::wait::Mapped;
use crate::model::dispatch::rows;
use crate::model::shared::{SENT_WORDS, Shared};
use crate::model::status::Status;

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
    steps_at: u32,
}

/// The rows of a dispatch on the device.
#[derive(Debug)]
struct Table {
    count: u32,
    block: wgpu::Buffer,
    indices: wgpu::Buffer,
    words: wgpu::Buffer,
}

/// The arrays of a world that have the rows.
#[derive(Debug)]
pub(crate) struct Arrays {
    pub(super) spheres: u32,
    pub(super) slots_at: u32,
    pub(super) state: wgpu::Buffer,
    pub(super) topology: wgpu::Buffer,
    pub(super) rates: wgpu::Buffer,
    pub(super) status: wgpu::Buffer,
}

/// What was submitted since a step began.
#[derive(Debug, Default)]
struct Submitted {
    /// Number of submissions with stages. After a rejected step there are several.
    count: u32,
    /// The rows that are sent, from the early part of the first submission.
    taken: Option<Mapped>,
    /// Where rows are put after that submission.
    ended: Option<Arrays>,
    /// Whether a sphere is far, after the rows were put.
    far: Option<Mapped>,
}

/// The tables on the device of what a process shares.
#[derive(Debug)]
pub(crate) struct Link {
    gpu: Gpu,
    kernels: Arc<Copiers>,
    sent: Table,
    received: Table,
    own: Table,
    is_far: wgpu::Buffer,
    /// Takes rows to the host.
    staging: wgpu::Buffer,
    /// Takes to the host whether a sphere is far.
    far_staging: wgpu::Buffer,
    /// Takes rows to the device.
    belt: Mutex<StagingBelt>,
    axis: u32,
    room: f32,
    is_verlet: bool,
    submitted: Mutex<Submitted>,
}

impl Link {
    /// Makes the tables.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when memory runs out, or an array of the world is larger than one binding may be.
    pub(crate) fn new(gpu: &Gpu, shared: &Shared, is_verlet: bool) -> Result<Self> {
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let device = gpu.device();
        let made = |name: &str, words: usize| make_buffer(device, name, 4 * words.max(1) as u64, storage);
        let table = |indices: &[u32], width: usize| -> Result<Table> {
            let table = Table {
                count: indices.len() as u32,
                block: make_buffer(device, "shared rows", size_of::<Block>() as u64, UNIFORM)?,
                indices: made("shared spheres", indices.len())?,
                words: made("shared rows", width * indices.len())?,
            };
            catch(device, || gpu.queue().write_buffer(&table.indices, 0, cast_slice(indices)))?;
            Ok(table)
        };
        let own = table(&shared.own, 1)?;
        catch(device, || gpu.queue().write_buffer(&own.words, 0, cast_slice(&shared.starts)))?;
        let sent = table(&shared.sent.concat(), SENT_WORDS)?;
        let received = table(&shared.received.concat(), SENT_WORDS)?;
        Ok(Self {
            kernels: gpu.sharers()?,
            staging: make_buffer(device, "shared rows", sent.words.size(), READ_BACK)?,
            far_staging: make_buffer(device, "far", 4, READ_BACK)?,
            belt: Mutex::new(StagingBelt::new(device.clone(), received.words.size())),
            is_far: made("far", 1)?,
            sent,
            received,
            own,
            axis: shared.axis as u32,
            room: shared.room as f32,
            is_verlet,
            submitted: Mutex::default(),
            gpu: gpu.clone(),
        })
    }

    /// Begins a step.
    pub(crate) fn begin(&self) {
        *lock(&self.submitted) = Submitted::default();
    }

    /// Number of submissions since the step began.
    pub(crate) fn submissions(&self) -> u32 {
        lock(&self.submitted).count
    }

    /// Notes that stages are submitted. Returns whether rows are to be taken after their early part.
    pub(super) fn note_submission(&self) -> bool {
        let mut submitted = lock(&self.submitted);
        submitted.count += 1;
        submitted.count == 1
    }

    /// Submits the early part of a step, which an encoder has, and the copies of the rows that are sent. `early` has them, and `ended` has
    /// those after the step.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(super) fn submit_early(&self, early: &Arrays, ended: Arrays, encoder: wgpu::CommandEncoder) -> Result<()> {
        let taken = self.submit_take(early, encoder)?;
        let mut submitted = lock(&self.submitted);
        (submitted.taken, submitted.ended) = (Some(taken), Some(ended));
        Ok(())
    }

    /// Reads the rows that are sent to each process, as soon as the early part of the step has been computed. Waits for ever if it is not
    /// submitted.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) async fn take_early(&self, to: &mut [Vec<u32>]) -> Result<()> {
        let taken = poll_fn(|_| lock(&self.submitted).taken.take().map_or(Poll::Pending, Poll::Ready)).await;
        self.read(taken, to).await
    }

    /// Writes the rows that were received in the step that [`Link::submit_early`] belongs to, once it has been computed. Steps have `dt`
    /// seconds.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) fn put_early(&self, from: &[Vec<u32>], dt: f32) -> Result<()> {
        let ended = lock(&self.submitted).ended.take();
        ended.map_or(Ok(()), |arrays| self.put(&arrays, from, dt))
    }

    /// Reads the rows that are sent to each process after a step.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) async fn take(&self, arrays: &Arrays, to: &mut [Vec<u32>]) -> Result<()> {
        let taken = self.submit_take(arrays, self.encoder())?;
        self.read(taken, to).await
    }

    /// Writes the rows that were received after a step, and then looks whether a sphere is far. Submits this without waiting for it.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) fn put(&self, arrays: &Arrays, from: &[Vec<u32>], dt: f32) -> Result<()> {
        let (device, queue, mut belt) = (self.gpu.device(), self.gpu.queue(), lock(&self.belt));
        let mut encoder = self.encoder();
        catch(device, || {
            let mut at = 0;
            for bytes in from.iter().map(|words| cast_slice::<u32, u8>(words)) {
                if let Some(size) = BufferSize::new(bytes.len() as u64) {
                    let mut view = belt.write_buffer(&mut encoder, &self.received.words, at, size);
                    view.copy_from_slice(bytes);
                    at += size.get();
                }
            }
            belt.finish();
        })?;
        self.encode(arrays, &mut encoder, &self.received, "put", 0.0)?;
        catch(device, || queue.write_buffer(&self.is_far, 0, &[0; 4]))?;
        self.encode(arrays, &mut encoder, &self.own, "look", dt)?;
        let submission = catch(device, || {
            encoder.copy_buffer_to_buffer(&self.is_far, 0, &self.far_staging, 0, 4);
            queue.submit([encoder.finish()])
        })?;
        belt.recall();
        lock(&self.submitted).far = Some(Mapped::read(&self.far_staging, self.gpu.faults()).after(submission));
        Ok(())
    }

    /// Whether some own sphere may leave its room in a step of `dt` seconds after the one whose rows were put last.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) when the device is lost.
    pub(crate) async fn is_far(&self) -> Result<bool> {
        let far = lock(&self.submitted).far.take();
        let Some(far) = far else { return Ok(false) };
        let view = far.bytes("far").await?;
        let is_far = view[0] != 0;
        drop(view);
        self.far_staging.unmap();
        Ok(is_far)
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Copies the rows that are sent, after what the encoder has.
    fn submit_take(&self, arrays: &Arrays, mut encoder: wgpu::CommandEncoder) -> Result<Mapped> {
        self.encode(arrays, &mut encoder, &self.sent, "take", 0.0)?;
        let submission = catch(self.gpu.device(), || {
            encoder.copy_buffer_to_buffer(&self.sent.words, 0, &self.staging, 0, self.staging.size());
            self.gpu.queue().submit([encoder.finish()])
        })?;
        Ok(Mapped::read(&self.staging, self.gpu.faults()).after(submission))
    }

    async fn read(&self, taken: Mapped, to: &mut [Vec<u32>]) -> Result<()> {
        let view = taken.bytes("shared rows").await?;
        let mut at = 0;
        for message in to {
            let bytes: &mut [u8] = cast_slice_mut(message);
            bytes.copy_from_slice(&view[at..at + bytes.len()]);
            at += bytes.len();
        }
        drop(view);
        self.staging.unmap();
        Ok(())
    }

    fn encode(
        &self,
        arrays: &Arrays,
        encoder: &mut wgpu::CommandEncoder,
        table: &Table,
        entry_point: &str,
        dt: f32,
    ) -> Result<()> {
        if table.count == 0 {
            return Ok(());
        }
        let Self { axis, room, is_verlet, .. } = *self;
        let Arrays { spheres, slots_at, .. } = *arrays;
        let steps_at = (offset_of!(Status, steps) / 4) as u32;
        let block = Block { spheres, slots_at, count: table.count, is_verlet: u32::from(is_verlet), axis, room, dt, steps_at };
        let Arrays { state, topology, rates, status, .. } = arrays;
        let buffers = [&table.block, state, topology, rates, &table.indices, &table.words, &self.is_far, status];
        let device = self.gpu.device();
        let across = device.limits().max_compute_workgroups_per_dimension;
        catch(device, || {
            self.gpu.queue().write_buffer(&table.block, 0, bytes_of(&block));
            let group = self.kernels.bind(device, &buffers);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            self.kernels.dispatch(&mut pass, entry_point, &group, rows(table.count.div_ceil(THREADS), across));
        })
    }
}

fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}
