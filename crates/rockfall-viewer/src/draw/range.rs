//! The automatic range of the colour scale.

use bytemuck::{Pod, Zeroable};
use rockfall::exec::gpu::catch;
use rockfall::{Result, Scene, wgpu};

use crate::draw::layouts::Layouts;
use crate::extent::Extent;
use crate::read_back::read_back;

/// Factor by which the recorded value decreases per frame, so that the scale shrinks slowly.
const DECAY: f32 = 0.98;
/// Part of the values that the scale contains, so that a few extreme ones do not make all others look alike.
const PART: f64 = 0.99;
/// Round numbers at which a scale ends, up to a power of ten. At least three quarters of the scale are in use.
const ENDS: [f32; 11] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// The 99th percentile of the values of the last frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RecentPercentile {
    value: f32,
}

impl RecentPercentile {
    pub(crate) fn record(&mut self, value: f32) {
        self.value = value.max(DECAY * self.value);
    }

    /// Returns the range from 0 to the next of [`ENDS`] times a power of ten.
    pub(crate) fn range(self) -> [f32; 2] {
        if !(self.value > 0.0 && self.value.is_finite()) {
            return [0.0, 1.0];
        }
        let power = 10_f32.powf(self.value.log10().floor());
        let ends = ENDS.map(|end| end * power);
        [0.0, ends.into_iter().find(|end| *end >= 0.999 * self.value).unwrap_or(10.0 * power)]
    }
}

/// Position of the percentile among this number of values in ascending order.
fn place(count: u64) -> u64 {
    ((PART * count as f64).ceil() as u64).clamp(1, count.max(1)) - 1
}

/// Returns the 99th percentile of the values greater than 0; 0 if there are none.
pub(crate) fn percentile(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: Vec<f32> = values.filter(|value| *value > 0.0 && value.is_finite()).collect();
    if values.is_empty() {
        return 0.0;
    }
    let place = place(values.len() as u64) as usize;
    *values.select_nth_unstable_by(place, f32::total_cmp).1
}

/// Returns the 99th percentile of the values of the spheres in a region, or of all if most are outside. `values` has one value
/// per sphere, in insertion order.
pub(crate) fn percentile_in(scene: &Scene, values: &[f32], region: Extent) -> f32 {
    let inside = |(sphere, value): (&rockfall::Sphere, &f32)| region.contains(sphere.position).then_some(*value);
    let near: Vec<f32> = scene.spheres().iter().zip(values).filter_map(inside).collect();
    let shown = if 2 * near.len() < values.len() { values } else { &near };
    percentile(shown.iter().copied())
}

/// Number of bins for each of the two groups of spheres; as in `wgsl/percentile.wgsl`.
const BINS: usize = 4096;
/// Bits of a float below its bin.
const BIN_SHIFT: u32 = 19;
/// Number of spheres that are counted at most.
const MOST_COUNTED: u32 = 1 << 18;
const WORKGROUP: u32 = 256;

/// The input of the shader, before the bins.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Input {
    spheres: u32,
    stride: u32,
    padding: [u32; 2],
    low: [f32; 4],
    high: [f32; 4],
}

const INPUT: u64 = size_of::<Input>() as u64;
const SIZE: u64 = INPUT + 8 * BINS as u64;

/// Computes the 99th percentile of the speeds on the device.
#[derive(Debug)]
pub(crate) struct SpeedPercentile {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    found: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl SpeedPercentile {
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let layout = Layouts::of_percentile(device);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("percentile"),
            source: wgpu::ShaderSource::Wgsl(include_str!("wgsl/percentile.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("percentile"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("percentile"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("count_speeds"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size: SIZE, usage, mapped_at_creation: false })
        };
        use wgpu::BufferUsages as Usage;
        let found = buffer("percentile", Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let staging = buffer("read back", Usage::MAP_READ | Usage::COPY_DST);
        Self { device: device.clone(), queue: queue.clone(), pipeline, layout, found, staging }
    }

    /// Returns the 99th percentile of the speeds greater than 0 of the spheres in a region, or of all if most are outside.
    pub(crate) fn of(&self, state: &wgpu::Buffer, spheres: u32, region: Extent) -> Result<f32> {
        if spheres == 0 {
            return Ok(0.0);
        }
        let stride = spheres.div_ceil(MOST_COUNTED);
        let [low, high] = [region.min, region.max].map(|corner| corner.extend(0.0).to_array());
        let input = Input { spheres, stride, padding: [0; 2], low, high };
        catch(&self.device, || {
            self.queue.write_buffer(&self.found, 0, bytemuck::bytes_of(&input));
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("percentile"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: state.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: self.found.as_entire_binding() },
                ],
            });
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.clear_buffer(&self.found, INPUT, None);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(spheres.div_ceil(stride).div_ceil(WORKGROUP), 1, 1);
            drop(pass);
            encoder.copy_buffer_to_buffer(&self.found, 0, &self.staging, 0, SIZE);
            self.queue.submit([encoder.finish()]);
        })?;
        let bins = read_back(&self.device, &self.staging, |bytes| {
            let counts = bytes[INPUT as usize..].chunks_exact(4);
            counts.map(bytemuck::pod_read_unaligned::<u32>).collect::<Vec<u32>>()
        })?;
        Ok(percentile_of_bins(&bins))
    }
}

/// Returns the upper end of the bin of the percentile. `bins` has the counts of the spheres in the region, then of the others.
fn percentile_of_bins(bins: &[u32]) -> f32 {
    let (inside, outside) = bins.split_at(BINS);
    let total = |bins: &[u32]| bins.iter().map(|count| u64::from(*count)).sum::<u64>();
    let with_others = total(outside) > total(inside);
    let count = |bin: usize| u64::from(inside[bin]) + if with_others { u64::from(outside[bin]) } else { 0 };
    let all: u64 = (0..BINS).map(count).sum();
    let mut left = place(all);
    for bin in 0..BINS {
        if count(bin) > left {
            return f32::from_bits((bin as u32 + 1) << BIN_SHIFT);
        }
        left -= count(bin);
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_end_at_round_values_and_shrink_slowly() {
        let range = |value: f32| RecentPercentile { value }.range()[1];
        assert_eq!([0.0, 0.29, 1.0, 1.3, 4.9, 5.5, 123.0].map(range), [1.0, 0.3, 1.0, 1.5, 5.0, 6.0, 150.0]);
        for k in 1..1000 {
            let value = 0.013 * k as f32;
            assert!((0.999..1.34).contains(&(range(value) / value)), "{value}: {}", range(value));
        }
        let mut recent = RecentPercentile::default();
        recent.record(4.0);
        recent.record(1.0);
        assert_eq!(recent.range(), [0.0, 4.0]);
    }

    #[test]
    fn the_percentile_leaves_out_one_of_a_hundred() {
        assert_eq!(percentile((1..=100).map(|value| value as f32)), 99.0);
        assert_eq!(percentile([3.0, 0.0, 7.0, f32::NAN].into_iter()), 7.0);
        assert_eq!(percentile([].into_iter()), 0.0);
    }

    #[test]
    fn bins_give_the_percentile_up_to_a_sixteenth() {
        let bins = |speeds: &[f32], outside: &[f32]| {
            let mut bins = vec![0; 2 * BINS];
            speeds.iter().for_each(|speed| bins[(speed.to_bits() >> BIN_SHIFT) as usize] += 1);
            outside.iter().for_each(|speed| bins[BINS + (speed.to_bits() >> BIN_SHIFT) as usize] += 1);
            bins
        };
        let speeds: Vec<f32> = (1..=1000).map(|k| 0.01 * k as f32).collect();
        let found = percentile_of_bins(&bins(&speeds, &[400.0]));
        assert!((9.9..9.9 * 1.0626).contains(&found), "{found}");
        // Without a majority in the region, all count.
        assert!(percentile_of_bins(&bins(&[1.0], &[400.0, 300.0])) >= 400.0);
        assert_eq!(percentile_of_bins(&bins(&[], &[])), 0.0);
    }
}
