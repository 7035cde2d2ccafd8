//! The kernels that copy tables; see `exchange.rs`.

/// The compiled kernels.
#[derive(Debug)]
pub(crate) struct Exchangers {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) gather: wgpu::ComputePipeline,
    pub(super) scatter: wgpu::ComputePipeline,
    pub(super) check: wgpu::ComputePipeline,
}

impl Exchangers {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let storage = wgpu::BufferBindingType::Storage { read_only: false };
        let kinds = [wgpu::BufferBindingType::Uniform, storage, storage, storage, storage];
        let entries = [0, 1, 2, 3, 4].map(|binding| {
            let ty = kinds[binding as usize];
            wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                count: None,
            }
        });
        let label = Some("exchange");
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let module = device.create_shader_module(wgpu::include_wgsl!("exchange.wgsl"));
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |entry_point| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let [gather, scatter, check] = ["gather", "scatter", "check"].map(pipeline);
        Self { layout, gather, scatter, check }
    }
}
