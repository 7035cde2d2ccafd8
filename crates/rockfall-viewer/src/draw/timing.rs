//! How long the passes of a frame take on the device.

use rockfall::{Error, Result, wgpu};

use crate::read_back::read_back;

/// The passes of a frame, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Choosing what is drawn.
    Cull,
    /// The shadow map.
    Shadows,
    /// The bodies; in large scenes, those seen in the last frame.
    Bodies,
    /// In large scenes: finding what is not covered.
    Uncover,
    /// In large scenes: drawing it.
    Uncovered,
    /// Ambient occlusion.
    Occlusion,
    /// The picture.
    Finish,
}

impl Pass {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Cull, Self::Shadows, Self::Bodies, Self::Uncover, Self::Uncovered, Self::Occlusion, Self::Finish];

    /// Its name.
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

/// Two timestamps a pass.
const STAMPS: u32 = 2 * Pass::ALL.len() as u32;

/// What a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTimes {
    /// Seconds of every pass of [`Pass::ALL`]; 0 for a pass that was left out.
    pub passes: [f64; 7],
    /// Spheres that were ray-cast.
    pub near: u32,
    /// Spheres that were drawn as discs.
    pub far: u32,
    /// Spheres in the shadow map.
    pub shadows: u32,
}

impl FrameTimes {
    /// Seconds of all passes.
    pub fn total(&self) -> f64 {
        self.passes.iter().sum()
    }
}

/// Timestamps around the passes.
#[derive(Debug)]
pub(crate) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f64,
    /// Which passes the last frame had.
    ran: [bool; 7],
}

/// Bytes of the timestamps, and of the draws after them.
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

    /// Copies what was stamped, and how much was drawn, to where the host can read it.
    pub(crate) fn end(&self, encoder: &mut wgpu::CommandEncoder, draws: &wgpu::Buffer) {
        encoder.resolve_query_set(&self.queries, 0..STAMPS, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, STAMP_BYTES);
        encoder.copy_buffer_to_buffer(draws, 0, &self.staging, STAMP_BYTES, DRAW_BYTES);
    }

    /// What the last frame took; waits for it.
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
