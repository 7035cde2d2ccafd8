//! Times of the passes of a frame on the device.

use rockfall::{Error, Result, wgpu};

use crate::read_back::read_back;

/// The passes of a frame, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Selects the spheres to draw.
    Cull,
    /// Draws the shadow map.
    Shadows,
    /// Draws the bodies; in large scenes only the spheres that were visible in the last frame.
    Bodies,
    /// In large scenes: selects the other spheres that are not hidden.
    Uncover,
    /// In large scenes: draws them.
    Uncovered,
    /// Computes the ambient occlusion.
    Occlusion,
    /// Writes the picture.
    Finish,
}

impl Pass {
    /// All passes.
    pub const ALL: [Self; 7] =
        [Self::Cull, Self::Shadows, Self::Bodies, Self::Uncover, Self::Uncovered, Self::Occlusion, Self::Finish];

    /// Name of the pass.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cull => "cull",
            Self::Shadows => "shadows",
            Self::Bodies => "bodies",
            Self::Uncover => "uncover",
            Self::Uncovered => "uncovered",
            Self::Occlusion => "occlusion",
            Self::Finish => "finish",
        }
    }
}

/// Number of timestamps: two per pass.
const STAMPS: u32 = 2 * Pass::ALL.len() as u32;

/// Times of a frame, and the number of spheres drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTimes {
    /// Time of each pass of [`Pass::ALL`], in s; 0 for a pass that did not run.
    pub passes: [f64; 7],
    /// Number of spheres that were ray-cast.
    pub near: u32,
    /// Number of spheres that were drawn as discs.
    pub far: u32,
    /// Number of spheres in the shadow map.
    pub shadows: u32,
}

impl FrameTimes {
    /// Time of all passes, in s.
    pub fn total(&self) -> f64 {
        self.passes.iter().sum()
    }
}

/// Measures the passes with timestamps.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// Nanoseconds per tick.
    period: f64,
    /// Which passes of [`Pass::ALL`] the last frame had.
    ran: [bool; 7],
}

/// Size of the timestamps in the staging buffer, and of the draw arguments after them, in bytes.
const STAMP_BYTES: u64 = 8 * STAMPS as u64;
const DRAW_BYTES: u64 = 80;

impl Timer {
    /// # Errors
    /// [`Error::Device`] when the device has no timestamps.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(Error::Device("the device has no timestamps, or was opened without them".to_owned()));
        }
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("frame"),
            ty: wgpu::QueryType::Timestamp,
            count: STAMPS,
        });
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        use wgpu::BufferUsages as Usage;
        Ok(Self {
            queries,
            resolved: buffer("timestamps", STAMP_BYTES, Usage::QUERY_RESOLVE | Usage::COPY_SRC),
            staging: buffer("read back", STAMP_BYTES + DRAW_BYTES, Usage::MAP_READ | Usage::COPY_DST),
            period: f64::from(queue.get_timestamp_period()),
            ran: [false; 7],
        })
    }

    pub(crate) fn begin(&mut self, ran: [bool; 7]) {
        self.ran = ran;
    }

    pub(crate) fn render(&self, pass: Pass) -> wgpu::RenderPassTimestampWrites<'_> {
        let [beginning, end] = [0, 1].map(|k| Some(2 * pass as u32 + k));
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: beginning,
            end_of_pass_write_index: end,
        }
    }

    pub(crate) fn compute(&self, pass: Pass) -> wgpu::ComputePassTimestampWrites<'_> {
        let [beginning, end] = [0, 1].map(|k| Some(2 * pass as u32 + k));
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: beginning,
            end_of_pass_write_index: end,
        }
    }

    /// Copies the timestamps and the draw arguments to a buffer that the host can read.
    pub(crate) fn end(&self, encoder: &mut wgpu::CommandEncoder, draws: &wgpu::Buffer) {
        encoder.resolve_query_set(&self.queries, 0..STAMPS, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, STAMP_BYTES);
        encoder.copy_buffer_to_buffer(draws, 0, &self.staging, STAMP_BYTES, DRAW_BYTES);
    }

    /// Waits for the last frame and returns its times.
    pub(crate) fn read(&self, device: &wgpu::Device) -> Result<FrameTimes> {
        read_back(device, &self.staging, |bytes| {
            let stamp = |index: usize| bytemuck::pod_read_unaligned::<u64>(&bytes[8 * index..8 * index + 8]);
            let drawn = |list: usize| {
                let at = STAMP_BYTES as usize + 16 * list + 4;
                bytemuck::pod_read_unaligned::<u32>(&bytes[at..at + 4])
            };
            let passes = std::array::from_fn(|pass| {
                let ticks = stamp(2 * pass + 1).saturating_sub(stamp(2 * pass));
                if self.ran[pass] { ticks as f64 * self.period * 1e-9 } else { 0.0 }
            });
            FrameTimes { passes, near: drawn(0) + drawn(3), far: drawn(1) + drawn(4), shadows: drawn(2) }
        })
    }
}
