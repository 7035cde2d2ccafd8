//! Copies of states between the arrays of a world, in the order of memory, and a table on the device in insertion order. Other
//! programs on the device, such as PyTorch, read and write such tables without a copy through the host.

use bytemuck::{Pod, Zeroable, bytes_of};

use crate::error::{Error, Result};
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, UNIFORM, make_buffer};
use crate::exec::gpu::wait::Mapped;
use crate::exec::gpu::world::GpuWorld;
use crate::model::buffer::Buffer;
use crate::model::dispatch::rows;
use crate::model::layout::RIGID_ROWS;

/// Threads per workgroup in `exchange.wgsl`.
const THREADS: u32 = 256;

/// A field of the spheres as a table of `f32` on the device: one row per sphere in order of addition, without gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Table {
    /// x, y, z, in units.
    Positions,
    /// x, y, z, in units/s.
    Velocities,
    /// x, y, z, in mass units²/s.
    AngularMomenta,
    /// Unit quaternions w, x, y, z.
    Orientations,
    /// External forces x, y, z, in mass units/s². Can only be written.
    Forces,
    /// Centres of mass x, y, z of the rigid bodies, in units. Can only be read, as all fields of bodies.
    BodyPositions,
    /// Velocities x, y, z of their centres of mass, in units/s.
    BodyVelocities,
    /// Their angular momenta x, y, z about the centres of mass, in mass units²/s.
    BodyAngularMomenta,
    /// Their orientations, unit quaternions w, x, y, z.
    BodyOrientations,
}

impl Table {
    /// Numbers per sphere or body.
    pub fn columns(self) -> u32 {
        if matches!(self, Self::Orientations | Self::BodyOrientations) { 4 } else { 3 }
    }

    /// Size in bytes for this number of spheres or bodies.
    pub fn bytes(self, count: usize) -> u64 {
        4 * u64::from(self.columns()) * count as u64
    }

    /// What every row must be.
    fn expected(self) -> &'static str {
        if self.columns() == 4 { "unit quaternions w, x, y, z" } else { "finite numbers" }
    }

    /// Whether it has a row for each rigid body, and not for each sphere.
    pub fn is_of_bodies(self) -> bool {
        matches!(self.place(), Some((Buffer::RigidBodies, _)))
    }

    /// The array that holds the field, and the region of it, counted in rows per sphere, or the row of a body.
    fn place(self) -> Option<(Buffer, u32)> {
        match self {
            Self::Positions => Some((Buffer::Start, 0)),
            Self::Velocities => Some((Buffer::Start, 1)),
            Self::AngularMomenta => Some((Buffer::Start, 2)),
            Self::Orientations => Some((Buffer::Orientations, 0)),
            Self::BodyPositions => Some((Buffer::RigidBodies, 0)),
            Self::BodyVelocities => Some((Buffer::RigidBodies, 2)),
            Self::BodyAngularMomenta => Some((Buffer::RigidBodies, 3)),
            Self::BodyOrientations => Some((Buffer::RigidBodies, 4)),
            Self::Forces => None,
        }
    }
}

/// The uniform block of `exchange.wgsl`.
#[derive(Clone, Copy, Zeroable, Pod)]
#[repr(C)]
struct Exchange {
    count: u32,
    first: u32,
    columns: u32,
    slots_at: u32,
    component: u32,
    /// First row of the low parts of positions that become 0 when the field is written; 0 for none.
    lows: u32,
    stride: u32,
    padding: u32,
}

impl GpuWorld {
    /// Copies a field of the state to `table`. Submits the copy without waiting for it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for [`Table::Forces`] and a buffer that is too small, [`Error::Device`] when the state is larger than
    /// the device's limit for one binding.
    pub fn read_table(&self, table: Table, into: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        if table.place().is_none() {
            return Err(Error::Invalid {
                field: "table",
                value: "forces".to_owned(),
                expected: "positions, velocities, angular momenta or orientations",
            });
        }
        self.read_rows(table, self.count_of(table), into)
    }

    /// [`GpuWorld::read_table`] for the first `count` spheres or bodies.
    pub(crate) fn read_rows(&self, table: Table, count: u32, into: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        let mut encoder = self.encoder();
        self.encode_exchange(&mut encoder, (table, count), into, None, "gather")?;
        Ok(self.gpu().queue().submit([encoder.finish()]))
    }

    /// Number of rows of a table. Bodies of the scene come before capsules and frames that move as bodies.
    fn count_of(&self, table: Table) -> u32 {
        let layout = &self.step().layout;
        if table.is_of_bodies() { layout.rigid_bodies } else { layout.spheres }
    }

    /// Copies `table` to a field of the state. Submits the copy without waiting for it. Forces need an entry for each sphere in
    /// the topology buffer.
    pub(crate) fn write_table(&self, table: Table, from: &wgpu::Buffer) -> Result<wgpu::SubmissionIndex> {
        let mut encoder = self.encoder();
        if table == Table::Forces {
            let (bytes, at) =
                (self.check_size(table, self.count_of(table), from)?, 4 * u64::from(self.step().layout.forces_at));
            let topology = self.buffer(Buffer::Topology)?;
            catch(self.gpu().device(), || encoder.copy_buffer_to_buffer(from, 0, topology, at, bytes))?;
        } else {
            self.encode_exchange(&mut encoder, (table, self.count_of(table)), from, None, "scatter")?;
        }
        Ok(self.gpu().queue().submit([encoder.finish()]))
    }

    /// Checks the numbers of a table.
    ///
    /// # Errors
    /// [`Error::Invalid`] for numbers that are not finite and for quaternions that are not unit quaternions.
    pub(crate) async fn check_table(&self, table: Table, buffer: &wgpu::Buffer) -> Result<()> {
        let device = self.gpu().device();
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let found = make_buffer(device, "first bad row", 4, usage)?;
        let staging = make_buffer(device, "first bad row", 4, READ_BACK)?;
        let mut encoder = self.encoder();
        self.gpu().queue().write_buffer(&found, 0, &u32::MAX.to_le_bytes());
        self.encode_exchange(&mut encoder, (table, self.count_of(table)), buffer, Some(&found), "check")?;
        encoder.copy_buffer_to_buffer(&found, 0, &staging, 0, 4);
        let submission = catch(device, || self.gpu().queue().submit([encoder.finish()]))?;
        let view = Mapped::read(&staging, self.gpu().faults()).after(submission).bytes("the check of a table").await?;
        match bytemuck::pod_read_unaligned(&view) {
            u32::MAX => Ok(()),
            row => Err(Error::Invalid { field: "table", value: format!("row {row}"), expected: table.expected() }),
        }
    }

    pub(super) fn encoder(&self) -> wgpu::CommandEncoder {
        self.gpu().device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Number of bytes of a table, after a check that the buffer holds as many.
    fn check_size(&self, table: Table, count: u32, buffer: &wgpu::Buffer) -> Result<u64> {
        let bytes = table.bytes(count as usize);
        if buffer.size() < bytes {
            return Err(Error::Invalid {
                field: "table",
                value: format!("{} bytes", buffer.size()),
                expected: "a buffer with room for a row per sphere or body",
            });
        }
        Ok(bytes)
    }

    fn encode_exchange(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (table, count): (Table, u32),
        buffer: &wgpu::Buffer,
        found: Option<&wgpu::Buffer>,
        kernel: &str,
    ) -> Result<()> {
        self.check_size(table, count, buffer)?;
        if count == 0 {
            return Ok(());
        }
        let step = self.step();
        // `check` does not read the array.
        let (array, region) = table.place().unwrap_or((Buffer::Start, 0));
        let block = Exchange {
            count,
            first: if table.is_of_bodies() { region } else { region * step.layout.spheres },
            columns: table.columns(),
            slots_at: if table.is_of_bodies() { 0 } else { step.layout.slots_at },
            // Rows hold x, y, z, w.
            component: if table.columns() == 4 { 3 } else { 0 },
            lows: if table == Table::Positions { 3 * step.layout.spheres } else { 0 },
            stride: if table.is_of_bodies() { RIGID_ROWS } else { 1 },
            padding: 0,
        };
        let (device, queue) = (self.gpu().device(), self.gpu().queue());
        let uniform = make_buffer(device, "exchange", size_of::<Exchange>() as u64, UNIFORM)?;
        let unused = make_buffer(device, "unused", 4, wgpu::BufferUsages::STORAGE)?;
        let buffers = [&uniform, self.buffer(array)?, self.buffer(Buffer::Topology)?, buffer, found.unwrap_or(&unused)];
        let kernels = self.gpu().exchangers()?;
        let across = device.limits().max_compute_workgroups_per_dimension;
        catch(device, || {
            queue.write_buffer(&uniform, 0, bytes_of(&block));
            let group = kernels.bind(device, &buffers);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            kernels.dispatch(&mut pass, kernel, &group, rows(count.div_ceil(THREADS), across));
        })
    }
}
