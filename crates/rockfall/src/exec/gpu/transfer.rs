//! Copies data between a [`World`] and its arrays on a device, piece by piece.

use bytemuck::bytes_of_mut;

use crate::error::{Error, Result};
use crate::exec::gpu::array::Piece;
use crate::exec::gpu::fault::catch;
use crate::exec::gpu::memory::{READ_BACK, make_buffer};
use crate::exec::gpu::wait::Mapped;
use crate::exec::gpu::world::GpuWorld;
use crate::model::buffer::Buffer;
use crate::model::status::Status;
use crate::model::world::World;

/// Bytes written or read in one piece. The limit keeps staging memory small compared with the buffers.
const PIECE: u64 = 128 << 20;

impl GpuWorld {
    /// Empties the list of every mover.
    pub(super) fn clear_lists(&self) -> Result<()> {
        let device = self.gpu().device();
        catch(device, || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            for piece in self.array(Buffer::Lists).pieces(4 * u64::from(self.step().layout.entries_at), u64::MAX) {
                encoder.clear_buffer(piece.buffer, piece.offset, Some(piece.range.end - piece.range.start));
            }
            self.gpu().queue().submit([encoder.finish()]);
        })
    }

    /// Uploads the first bytes of an array.
    pub(super) fn write(&self, buffer: Buffer, bytes: &[u8]) -> Result<()> {
        for piece in self.array(buffer).pieces(bytes.len() as u64, PIECE) {
            let part = &bytes[piece.range.start as usize..piece.range.end as usize];
            catch(self.gpu().device(), || {
                let queue = self.gpu().queue();
                queue.write_buffer(piece.buffer, piece.offset, part);
                if part.len() as u64 >= PIECE / 2 {
                    // Releases the staging memory.
                    queue.submit([]);
                }
            })?;
        }
        Ok(())
    }

    /// Reads the status block.
    ///
    /// # Errors
    /// [`Error::Device`] when the device is lost.
    pub async fn read_status(&self) -> Result<Status> {
        let mut status = Status::default();
        self.read(Buffer::Status, bytes_of_mut(&mut status)).await?;
        Ok(status)
    }

    /// Reads buffers back into a world of the same sizes.
    ///
    /// # Errors
    /// [`Error::Device`] when the device is lost or out of memory, or the world is larger than the one on the device.
    pub async fn download(&self, world: &mut World, buffers: &[Buffer]) -> Result<()> {
        for buffer in buffers {
            self.read(*buffer, world.bytes_mut(*buffer)).await?;
        }
        Ok(())
    }

    async fn read(&self, buffer: Buffer, into: &mut [u8]) -> Result<()> {
        self.gpu().faults().check()?;
        if into.len() as u64 > self.array(buffer).size() {
            return Err(Error::Device(format!("{} on the device is smaller than the host's", buffer.label())));
        }
        for piece in self.array(buffer).pieces(into.len() as u64, PIECE) {
            let staging = self.stage(&piece)?;
            let view = Mapped::read(&staging, self.gpu().faults()).bytes(buffer.label()).await?;
            into[piece.range.start as usize..piece.range.end as usize].copy_from_slice(&view);
        }
        Ok(())
    }

    /// Copies a piece of an array to a buffer that the host can read.
    fn stage(&self, piece: &Piece) -> Result<wgpu::Buffer> {
        let device = self.gpu().device();
        let size = piece.range.end - piece.range.start;
        let staging = make_buffer(device, "read back", size, READ_BACK)?;
        catch(device, || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(piece.buffer, piece.offset, &staging, 0, size);
            self.gpu().queue().submit([encoder.finish()]);
        })?;
        Ok(staging)
    }
}
