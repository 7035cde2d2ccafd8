//! From WGSL parts to pipelines.

use rockfall::wgpu;

use crate::draw::targets::{DEPTH_FORMAT, LIGHT_FORMAT, SAMPLES};

macro_rules! wgsl {
    ($($name:literal),*) => { concat!($(include_str!(concat!("wgsl/", $name, ".wgsl"))),*) };
}

/// What shaders see.
#[derive(Debug)]
pub(crate) struct Layouts {
    /// Group 0: the frame and the physics' buffers.
    pub(crate) bodies: wgpu::BindGroupLayout,
    /// Group 1 of the last pass.
    pub(crate) finish: wgpu::BindGroupLayout,
}

/// Storage buffers of group 0, after the frame.
pub(crate) const STORAGE: u32 = 7;

fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let mut bodies = vec![entry(0, stages, buffer(wgpu::BufferBindingType::Uniform))];
        let storage = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        bodies.extend((1..=STORAGE).map(|binding| entry(binding, stages, storage)));
        let light = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let layout = |label, entries: &[_]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        Self { bodies: layout("bodies", &bodies), finish: layout("finish", &[entry(0, wgpu::ShaderStages::FRAGMENT, light)]) }
    }
}

/// Every way of drawing.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) spheres: wgpu::RenderPipeline,
    pub(crate) finish: wgpu::RenderPipeline,
}

struct Recipe<'a> {
    label: &'a str,
    text: &'a str,
    entries: [&'a str; 2],
    layouts: &'a [Option<&'a wgpu::BindGroupLayout>],
    format: wgpu::TextureFormat,
    topology: wgpu::PrimitiveTopology,
    /// Into the samples, with depth; else onto the caller's texture.
    in_depth: bool,
    constants: &'a [(&'a str, f64)],
}

impl Recipe<'_> {
    fn make(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let source = wgpu::ShaderSource::Wgsl(self.text.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(self.label), source });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: self.layouts,
            immediate_size: 0,
        });
        let compilation_options = wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        let depth = wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(self.entries[0]),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: self.in_depth.then_some(depth),
            multisample: wgpu::MultisampleState { count: if self.in_depth { SAMPLES } else { 1 }, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(self.entries[1]),
                compilation_options,
                targets: &[Some(self.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts, format: wgpu::TextureFormat) -> Self {
        let spheres = Recipe {
            label: "spheres",
            text: wgsl!("frame", "colour", "light", "surface", "sphere"),
            entries: ["sphere_vertex", "sphere_surface"],
            layouts: &[Some(&layouts.bodies)],
            format: LIGHT_FORMAT,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            in_depth: true,
            constants: &[],
        };
        let finish = Recipe {
            label: "finish",
            text: wgsl!("frame", "finish"),
            entries: ["whole_picture", "finish"],
            layouts: &[Some(&layouts.bodies), Some(&layouts.finish)],
            format,
            topology: wgpu::PrimitiveTopology::TriangleList,
            in_depth: false,
            constants: &[("ENCODES", f64::from(u8::from(format.is_srgb())))],
        };
        Self { spheres: spheres.make(device), finish: finish.make(device) }
    }
}
