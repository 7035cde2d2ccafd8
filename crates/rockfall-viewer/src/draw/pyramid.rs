//! The depth pyramid (Greene et al. 1993): the farthest depth of blocks of pixels, from 2 by 2 pixels to the whole picture.
//! It is used to find hidden spheres; see `wgsl/pyramid.wgsl`.

use rockfall::wgpu;

use crate::draw::layouts::{entry, texture};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Number of blocks along a side of a workgroup.
const WORKGROUP: u32 = 8;

/// Pipelines that build the levels: the first from the samples of the picture, every other from the level before.
#[derive(Debug)]
pub(crate) struct PyramidBuilder {
    first: wgpu::ComputePipeline,
    next: wgpu::ComputePipeline,
    layouts: [wgpu::BindGroupLayout; 2],
    /// Layout of the bind group that reads the pyramid.
    pub(crate) read: wgpu::BindGroupLayout,
}

impl PyramidBuilder {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let compute = |binding, ty| entry(binding, wgpu::ShaderStages::COMPUTE, ty);
        let samples = compute(0, texture(wgpu::TextureSampleType::Depth, true));
        let blocks = |binding| compute(binding, texture(wgpu::TextureSampleType::Float { filterable: false }, false));
        let target = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = |entries: &[_]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("pyramid"), entries })
        };
        let layouts = [layout(&[samples, compute(2, target)]), layout(&[blocks(1), compute(2, target)])];
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("pyramid"),
            source: wgpu::ShaderSource::Wgsl(include_str!("wgsl/pyramid.wgsl").into()),
        });
        let pipeline = |layout: &wgpu::BindGroupLayout, name: &str| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(layout)],
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        Self {
            first: pipeline(&layouts[0], "first_level"),
            next: pipeline(&layouts[1], "next_level"),
            read: layout(&[blocks(0)]),
            layouts,
        }
    }
}

/// The depth pyramid of a picture of one size.
#[derive(Debug)]
pub(crate) struct Pyramid {
    /// Bind group that builds each level, and the size of the level.
    levels: Vec<(wgpu::BindGroup, [u32; 2])>,
    /// Bind group that reads all levels.
    pub(crate) group: wgpu::BindGroup,
}

impl Pyramid {
    pub(crate) fn new(device: &wgpu::Device, builder: &PyramidBuilder, samples: &wgpu::TextureView, size: [u32; 2]) -> Self {
        let size = size.map(|side| (side / 2).max(1));
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("pyramid"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: size[0].max(size[1]).ilog2() + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |base_mip_level, mip_level_count| {
            texture.create_view(&wgpu::TextureViewDescriptor { base_mip_level, mip_level_count, ..Default::default() })
        };
        let group = |layout, entries: &[(u32, &wgpu::TextureView)]| {
            let entries: Vec<_> = entries
                .iter()
                .map(|(binding, view)| wgpu::BindGroupEntry {
                    binding: *binding,
                    resource: wgpu::BindingResource::TextureView(view),
                })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("pyramid"), layout, entries: &entries })
        };
        let levels = (0..texture.mip_level_count()).map(|level| {
            let target = view(level, Some(1));
            let group = match level.checked_sub(1) {
                None => group(&builder.layouts[0], &[(0, samples), (2, &target)]),
                Some(before) => group(&builder.layouts[1], &[(1, &view(before, Some(1))), (2, &target)]),
            };
            (group, size.map(|side| (side >> level).max(1)))
        });
        Self { levels: levels.collect(), group: group(&builder.read, &[(0, &view(0, None))]) }
    }

    /// Builds all levels from the present depths.
    pub(crate) fn build(&self, pass: &mut wgpu::ComputePass<'_>, builder: &PyramidBuilder) {
        for (level, (group, size)) in self.levels.iter().enumerate() {
            pass.set_pipeline(if level == 0 { &builder.first } else { &builder.next });
            pass.set_bind_group(0, group, &[]);
            let [across, down] = size.map(|side| side.div_ceil(WORKGROUP));
            pass.dispatch_workgroups(across, down, 1);
        }
    }
}
