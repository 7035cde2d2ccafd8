//! The kernels that copy tables; see `exchange.rs`.

use crate::exec::gpu::kernel::layout_entry;

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
        let mut entries = vec![layout_entry(0, wgpu::BufferBindingType::Uniform)];
        entries.extend((1..5).map(|binding| layout_entry(binding, storage)));
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
