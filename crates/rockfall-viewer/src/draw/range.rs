//! The automatic range of the colour scale.

use rockfall::Result;
use rockfall::exec::gpu::catch;
use rockfall::wgpu;

use crate::draw::layouts::Layouts;
use crate::read_back::read_back;

/// Factor by which the recorded maximum decreases per frame, so that the scale shrinks slowly.
const DECAY: f32 = 0.98;

/// The greatest value of the last frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RecentMaximum {
    value: f32,
}

impl RecentMaximum {
    pub(crate) fn record(&mut self, value: f32) {
        self.value = value.max(DECAY * self.value);
    }

    /// Returns the range from 0 to the next of 1, 2, 5, 10, ... times a power of ten.
    pub(crate) fn range(self) -> [f32; 2] {
        if !(self.value > 0.0 && self.value.is_finite()) {
            return [0.0, 1.0];
        }
        let power = 10_f32.powf(self.value.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
        [0.0, steps.into_iter().find(|step| *step >= 0.999 * self.value).unwrap_or(10.0 * power)]
    }
}

/// Computes the greatest speed on the device and reads this one number back.
#[derive(Debug)]
pub(crate) struct SpeedReduction {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    found: wgpu::Buffer,
    staging: wgpu::Buffer,
}

/// Number of spheres that a workgroup reads at once; as in `wgsl/greatest.wgsl`.
const WORKGROUP: u32 = 256;
const MOST_WORKGROUPS: u32 = 1024;

impl SpeedReduction {
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let layout = Layouts::of_greatest(device);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("greatest"),
            source: wgpu::ShaderSource::Wgsl(include_str!("wgsl/greatest.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("greatest"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("greatest"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("greatest_speed"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let buffer = |label, usage| {
            let descriptor = wgpu::BufferDescriptor { label: Some(label), size: 16, usage, mapped_at_creation: false };
            device.create_buffer(&descriptor)
        };
        use wgpu::BufferUsages as Usage;
        let found = buffer("greatest", Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let staging = buffer("read back", Usage::MAP_READ | Usage::COPY_DST);
        Self { device: device.clone(), queue: queue.clone(), pipeline, layout, found, staging }
    }

    /// Returns the greatest speed in a state of `spheres` spheres.
    pub(crate) fn greatest(&self, state: &wgpu::Buffer, spheres: u32) -> Result<f32> {
        if spheres == 0 {
            return Ok(0.0);
        }
        catch(&self.device, || {
            self.queue.write_buffer(&self.found, 0, bytemuck::cast_slice(&[0_u32, spheres, 0, 0]));
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("greatest"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: state.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: self.found.as_entire_binding() },
                ],
            });
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(spheres.div_ceil(WORKGROUP).min(MOST_WORKGROUPS), 1, 1);
            drop(pass);
            encoder.copy_buffer_to_buffer(&self.found, 0, &self.staging, 0, 16);
            self.queue.submit([encoder.finish()]);
        })?;
        let bits = read_back(&self.device, &self.staging, |bytes| bytemuck::pod_read_unaligned::<u32>(&bytes[..4]))?;
        Ok(f32::from_bits(bits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_end_at_round_values_and_shrink_slowly() {
        let range = |value: f32| RecentMaximum { value }.range()[1];
        assert_eq!([0.0, 0.3, 1.0, 1.2, 4.9, 5.5, 123.0].map(range), [1.0, 0.5, 1.0, 2.0, 5.0, 10.0, 200.0]);
        let mut greatest = RecentMaximum::default();
        greatest.record(4.0);
        greatest.record(1.0);
        assert_eq!(greatest.range(), [0.0, 5.0]);
    }
}
