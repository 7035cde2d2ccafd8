//! Bind group layouts of the shaders.

use rockfall::wgpu;

/// Bind group layouts of the render passes.
#[derive(Debug)]
pub(crate) struct Layouts {
    /// Group 0: the uniform block and the buffers of the physics.
    pub(crate) bodies: wgpu::BindGroupLayout,
    /// Group 1 of lit surfaces: the shadow map.
    pub(crate) shadows: wgpu::BindGroupLayout,
    /// Group 1 of ambient occlusion.
    pub(crate) occlusion: wgpu::BindGroupLayout,
    /// Group 1 of the last pass.
    pub(crate) finish: wgpu::BindGroupLayout,
}

/// Number of storage buffers in group 0, which follow the uniform block.
pub(crate) const STORAGE: u32 = 8;

pub(crate) fn entry(binding: u32, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

fn buffer(ty: wgpu::BufferBindingType) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None }
}

pub(crate) fn texture(sample_type: wgpu::TextureSampleType, multisampled: bool) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled }
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let fragment = |binding, ty| entry(binding, wgpu::ShaderStages::FRAGMENT, ty);
        let mut bodies = vec![entry(0, stages, buffer(wgpu::BufferBindingType::Uniform))];
        let storage = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        bodies.extend((1..=STORAGE).map(|binding| entry(binding, stages, storage)));
        let colour = texture(wgpu::TextureSampleType::Float { filterable: false }, false);
        let depth = texture(wgpu::TextureSampleType::Depth, false);
        let depths = texture(wgpu::TextureSampleType::Depth, true);
        let nearer = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let layout = |label, entries: &[_]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        Self {
            bodies: layout("bodies", &bodies),
            shadows: layout("shadows", &[entry(0, stages, depth), entry(1, stages, nearer)]),
            occlusion: layout("occlusion", &[fragment(0, depths)]),
            finish: layout("finish", &[fragment(0, colour), fragment(1, colour), fragment(2, depths)]),
        }
    }

    /// Bindings of group 0 that culling reads: state, topology, old positions, capsule bits.
    pub(crate) const CULL_READS: [u32; 4] = [1, 3, 4, 7];

    /// Layout of the culling shaders: the uniform block, the buffers they read, and from 9 on the buffers they write.
    pub(crate) fn of_cull(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let storage = |binding, read_only| {
            entry(binding, wgpu::ShaderStages::COMPUTE, buffer(wgpu::BufferBindingType::Storage { read_only }))
        };
        let mut entries = vec![entry(0, wgpu::ShaderStages::COMPUTE, buffer(wgpu::BufferBindingType::Uniform))];
        entries.extend(Self::CULL_READS.map(|binding| storage(binding, true)));
        entries.extend([9, 10, 11].map(|binding| storage(binding, false)));
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("cull"), entries: &entries })
    }

    /// Layout of the speed reduction: the state and the result.
    pub(crate) fn of_percentile(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let storage = |binding, read_only| {
            entry(binding, wgpu::ShaderStages::COMPUTE, buffer(wgpu::BufferBindingType::Storage { read_only }))
        };
        let entries = [storage(0, true), storage(1, false)];
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("percentile"), entries: &entries })
    }
}
