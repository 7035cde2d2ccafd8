//! Lists of the spheres that are worth drawing, made on the device; see `wgsl/cull.wgsl`.

use std::ops::Range;

use rockfall::wgpu;

use crate::draw::pipelines::{CULL, Layouts};

/// Spheres that a workgroup looks at.
const WORKGROUP: u32 = 256;
/// Vertices of a sphere.
const CORNERS: u32 = 4;
/// Bytes of the arguments of an indirect draw.
const DRAW_BYTES: u64 = 16;

/// The lists, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum List {
    /// Spheres that are ray-cast.
    Near,
    /// Spheres of a few pixels.
    Far,
    /// Spheres in the shadow map.
    Shadow,
}

const LISTS: u64 = 3;

/// What makes the lists.
#[derive(Debug)]
pub(crate) struct Cull {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    lists: wgpu::Buffer,
    draws: wgpu::Buffer,
    spheres: u32,
    group: Option<wgpu::BindGroup>,
}

fn make_lists(device: &wgpu::Device, spheres: u32) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("spheres to draw"),
        size: (LISTS * 4 * u64::from(spheres)).max(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    })
}

impl Cull {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let layout = Layouts::of_cull(device);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("cull"),
            source: wgpu::ShaderSource::Wgsl(CULL.into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("cull"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("cull"),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("cull"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let draws = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("draws"),
            size: LISTS * DRAW_BYTES,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::INDIRECT
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self { pipeline, layout, lists: make_lists(device, 0), draws, spheres: 0, group: None }
    }

    /// Binds the uniform block and the buffers of group 0 (state first) that the lists are made from.
    pub(crate) fn bind(&mut self, device: &wgpu::Device, uniform: &wgpu::Buffer, buffers: &[wgpu::Buffer], spheres: u32) {
        if self.spheres != spheres {
            self.lists = make_lists(device, spheres);
            self.spheres = spheres;
        }
        let of_bodies = Layouts::CULL_READS.map(|binding| (binding, &buffers[binding as usize - 1]));
        let own = [(0, uniform), (9, &self.lists), (10, &self.draws)];
        let entries: Vec<_> = own
            .into_iter()
            .chain(of_bodies)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &self.layout;
        self.group =
            Some(device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("cull"), layout, entries: &entries }));
    }

    /// Makes the lists of the frame.
    pub(crate) fn run(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        let empty = [CORNERS, 0, 0, 0];
        queue.write_buffer(&self.draws, 0, bytemuck::cast_slice(&[empty; LISTS as usize]));
        let descriptor = wgpu::ComputePassDescriptor { label: Some("cull"), timestamp_writes: timestamps };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        let groups = self.spheres.div_ceil(WORKGROUP);
        if groups > 0 {
            let across = groups.min(device.limits().max_compute_workgroups_per_dimension);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(across, groups.div_ceil(across), 1);
        }
    }

    /// Draws the spheres of a list with the pipeline that is set.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, list: List) {
        if self.spheres == 0 {
            return;
        }
        pass.set_vertex_buffer(0, self.lists.slice(self.part(list)));
        pass.draw_indirect(&self.draws, list as u64 * DRAW_BYTES);
    }

    fn part(&self, list: List) -> Range<u64> {
        let bytes = 4 * u64::from(self.spheres);
        list as u64 * bytes..(list as u64 + 1) * bytes
    }

    /// The arguments of the draws, for who wants to know how much is drawn.
    pub(crate) fn draws(&self) -> &wgpu::Buffer {
        &self.draws
    }
}
