//! An array on the device. It is one buffer, or several chunks if it is larger than the device's limit for one binding.

use std::ops::Range;

use crate::error::Result;
use crate::exec::gpu::memory::make_buffer;
use crate::model::buffer::Buffer;

/// The buffers of one array.
#[derive(Debug)]
pub(crate) struct Array {
    /// All chunks have the same size except the last, which may be smaller.
    chunks: Vec<wgpu::Buffer>,
    /// Bytes of each chunk except the last.
    chunk_bytes: u64,
}

/// A range of an array that lies within one of its buffers.
pub(crate) struct Piece<'a> {
    pub(crate) buffer: &'a wgpu::Buffer,
    /// Offset of the range in the buffer, in bytes.
    pub(crate) offset: u64,
    /// The range within the whole array, in bytes.
    pub(crate) range: Range<u64>,
}

impl Array {
    /// Creates an array of `size` bytes in chunks of at most `chunk_bytes` each.
    pub(crate) fn new(device: &wgpu::Device, buffer: Buffer, size: u64, chunk_bytes: u64) -> Result<Self> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let sizes = (0..size.div_ceil(chunk_bytes)).map(|chunk| chunk_bytes.min(size - chunk * chunk_bytes));
        let chunks = sizes.map(|size| make_buffer(device, buffer.label(), size, usage)).collect::<Result<_>>()?;
        Ok(Self { chunks, chunk_bytes })
    }

    pub(crate) fn chunks(&self) -> &[wgpu::Buffer] {
        &self.chunks
    }

    pub(crate) fn size(&self) -> u64 {
        self.chunks.iter().map(wgpu::Buffer::size).sum()
    }

    /// The first `bytes` bytes of the array, in pieces of at most `most` bytes.
    pub(crate) fn pieces(&self, bytes: u64, most: u64) -> impl Iterator<Item = Piece<'_>> {
        let mut from = 0;
        std::iter::from_fn(move || {
            let offset = from % self.chunk_bytes;
            let to = bytes.min(from.saturating_add(most)).min(from - offset + self.chunk_bytes);
            let buffer = self.chunks.get(usize::try_from(from / self.chunk_bytes).ok()?)?;
            let range = std::mem::replace(&mut from, to)..to;
            (!range.is_empty()).then_some(Piece { buffer, offset, range })
        })
    }
}
