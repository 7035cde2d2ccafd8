//! The farthest depth of blocks of pixels, from 2 by 2 to the whole picture, which tells what is covered (Greene et al. 1993);
//! see `wgsl/pyramid.wgsl`.

use rockfall::wgpu;

use crate::draw::layouts::{entry, texture};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Blocks along a side of a workgroup.
const WORKGROUP: u32 = 8;

/// The two ways to make a level: from the samples of the picture, and from the level before.
#[derive(Debug)]
pub(crate) struct MakePyramid {
    first: wgpu::ComputePipeline,
    next: wgpu::ComputePipeline,
    layouts: [wgpu::BindGroupLayout; 2],
    /// Of what reads the pyramid.
    pub(crate) read: wgpu::BindGroupLayout,
}

impl MakePyramid {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let compute = |binding, ty| entry(binding, wgpu::ShaderStages::COMPUTE, ty);
        let samples = compute(0, texture(wgpu::TextureSampleType::Depth, true));
        let blocks = |binding| compute(binding, texture(wgpu::TextureSampleType::Float { filterable: false }, false));
        let made = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: FORMAT,
            view_dimension: wgpu::TextureViewDimension::D2,
        };
        let layout = |entries: &[_]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("pyramid"), entries })
        };
        let layouts = [layout(&[samples, compute(2, made)]), layout(&[blocks(1), compute(2, made)])];
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

/// The levels for a picture of one size.
#[derive(Debug)]
pub(crate) struct Pyramid {
    /// What to bind to make each level, and its size.
    levels: Vec<(wgpu::BindGroup, [u32; 2])>,
    /// What reads all levels.
    pub(crate) group: wgpu::BindGroup,
}

impl Pyramid {
    pub(crate) fn new(device: &wgpu::Device, make: &MakePyramid, samples: &wgpu::TextureView, size: [u32; 2]) -> Self {
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
            let made = view(level, Some(1));
            let group = match level.checked_sub(1) {
                None => group(&make.layouts[0], &[(0, samples), (2, &made)]),
                Some(before) => group(&make.layouts[1], &[(1, &view(before, Some(1))), (2, &made)]),
            };
            (group, size.map(|side| (side >> level).max(1)))
        });
        Self { levels: levels.collect(), group: group(&make.read, &[(0, &view(0, None))]) }
    }

    /// Makes all levels from the samples as they are.
    pub(crate) fn make(&self, pass: &mut wgpu::ComputePass<'_>, make: &MakePyramid) {
        for (level, (group, size)) in self.levels.iter().enumerate() {
            pass.set_pipeline(if level == 0 { &make.first } else { &make.next });
            pass.set_bind_group(0, group, &[]);
            let [across, down] = size.map(|side| side.div_ceil(WORKGROUP));
            pass.dispatch_workgroups(across, down, 1);
        }
    }
}
