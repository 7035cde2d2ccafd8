//! Culling: builds the lists of the spheres that are drawn, on the device; see `wgsl/cull.wgsl`.

use std::ops::Range;

use rockfall::model::dispatch::rows;
use rockfall::wgpu;

use crate::draw::layouts::Layouts;
use crate::draw::pipelines::CULL;

/// Number of spheres per workgroup.
const WORKGROUP: u32 = 256;
/// Number of vertices of a sphere.
const CORNERS: u32 = 4;
/// Size of the arguments of an indirect draw, in bytes.
const DRAW_BYTES: u64 = 16;

/// The lists, in the order of the buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum List {
    /// Spheres that are ray-cast.
    Near,
    /// Spheres of a few pixels, drawn as discs.
    Far,
    /// Spheres in the shadow map.
    Shadow,
    /// Near spheres that were hidden in the last frame.
    SecondNear,
    /// Far spheres that were hidden in the last frame.
    SecondFar,
}

const LISTS: u64 = 5;

/// Pipelines and buffers of the culling.
#[derive(Debug)]
pub(crate) struct Cull {
    cull: wgpu::ComputePipeline,
    uncover: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    lists: wgpu::Buffer,
    /// Whether each sphere was visible in the last frame.
    visible: wgpu::Buffer,
    draws: wgpu::Buffer,
    spheres: u32,
    group: Option<wgpu::BindGroup>,
}

/// Creates a buffer with `words` words per sphere, all 0.
fn make(device: &wgpu::Device, label: &str, words: u64, spheres: u32) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: (words * 4 * u64::from(spheres)).max(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX,
        mapped_at_creation: false,
    })
}

impl Cull {
    /// Creates the pipelines; `pyramid` is the layout of the bind group that reads the depth pyramid.
    pub(crate) fn new(device: &wgpu::Device, pyramid: &wgpu::BindGroupLayout) -> Self {
        let layout = Layouts::of_cull(device);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("cull"),
            source: wgpu::ShaderSource::Wgsl(CULL.into()),
        });
        let pipeline = |name: &str, bind_group_layouts: &[_]| {
            let descriptor = wgpu::PipelineLayoutDescriptor { label: Some(name), bind_group_layouts, immediate_size: 0 };
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&device.create_pipeline_layout(&descriptor)),
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let cull = pipeline("cull", &[Some(&layout)]);
        let uncover = pipeline("uncover", &[Some(&layout), Some(pyramid)]);
        let draws = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("draws"),
            size: LISTS * DRAW_BYTES,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::INDIRECT
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let [lists, visible] = ["spheres to draw", "visible spheres"].map(|label| make(device, label, 0, 0));
        Self { cull, uncover, layout, lists, visible, draws, spheres: 0, group: None }
    }

    /// Binds the uniform block and the buffers of group 0 (state first).
    pub(crate) fn bind(&mut self, device: &wgpu::Device, uniform: &wgpu::Buffer, buffers: &[wgpu::Buffer], spheres: u32) {
        if self.spheres != spheres {
            self.lists = make(device, "spheres to draw", LISTS, spheres);
            self.visible = make(device, "visible spheres", 1, spheres);
            self.spheres = spheres;
        }
        let of_bodies = Layouts::CULL_READS.map(|binding| (binding, &buffers[binding as usize - 1]));
        let own = [(0, uniform), (9, &self.lists), (10, &self.draws), (11, &self.visible)];
        let entries: Vec<_> = own
            .into_iter()
            .chain(of_bodies)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &self.layout;
        self.group =
            Some(device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("cull"), layout, entries: &entries }));
    }

    /// Empties the lists.
    pub(crate) fn begin(&self, queue: &wgpu::Queue) {
        let empty = [CORNERS, 0, 0, 0];
        queue.write_buffer(&self.draws, 0, bytemuck::cast_slice(&[empty; LISTS as usize]));
    }

    /// Builds the lists of the first pass. In large scenes only spheres that were visible in the last frame are candidates
    /// for the near and far lists.
    pub(crate) fn select(&self, pass: &mut wgpu::ComputePass<'_>, across: u32) {
        pass.set_pipeline(&self.cull);
        self.dispatch(pass, across);
    }

    /// Builds the lists of the second pass: spheres that were hidden in the last frame and are visible now. Records which
    /// spheres are visible.
    pub(crate) fn uncover(&self, pass: &mut wgpu::ComputePass<'_>, across: u32, pyramid: &wgpu::BindGroup) {
        pass.set_pipeline(&self.uncover);
        pass.set_bind_group(1, pyramid, &[]);
        self.dispatch(pass, across);
    }

    /// Dispatches one thread per sphere, in rows of at most `across` workgroups.
    fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, across: u32) {
        let groups = self.spheres.div_ceil(WORKGROUP);
        if groups > 0 {
            let [x, y, z] = rows(groups, across);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(x, y, z);
        }
    }

    /// Draws the spheres of a list with the current pipeline.
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

    /// Returns the arguments of the indirect draws, which include the numbers of spheres drawn.
    pub(crate) fn draws(&self) -> &wgpu::Buffer {
        &self.draws
    }
}
