//! Kernels that copy between the arrays of a world and tables; see `exchange.rs` and `share.rs`.

use crate::exec::gpu::kernel::layout_entry;

/// The compiled kernels of a WGSL file. Binding 0 is a uniform block, the others are storage buffers.
#[derive(Debug)]
pub(crate) struct Copiers {
    pub(super) layout: wgpu::BindGroupLayout,
    pipelines: Vec<(&'static str, wgpu::ComputePipeline)>,
}

impl Copiers {
    /// Compiles the entry points of a file that has this number of bindings.
    pub(super) fn new(
        device: &wgpu::Device,
        file: wgpu::ShaderModuleDescriptor<'_>,
        bindings: u32,
        entry_points: [&'static str; 3],
    ) -> Self {
        let storage = wgpu::BufferBindingType::Storage { read_only: false };
        let mut entries = vec![layout_entry(0, wgpu::BufferBindingType::Uniform)];
        entries.extend((1..bindings).map(|binding| layout_entry(binding, storage)));
        let label = Some("copies");
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let module = device.create_shader_module(file);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |entry_point| {
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            (entry_point, pipeline)
        };
        let pipelines = entry_points.map(pipeline).into();
        Self { layout, pipelines }
    }

    /// The bind group of these buffers, in the order of their bindings.
    pub(super) fn bind(&self, device: &wgpu::Device, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("copies"), layout: &self.layout, entries: &entries })
    }

    /// Adds a dispatch of an entry point to a pass.
    pub(super) fn dispatch(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        entry_point: &str,
        group: &wgpu::BindGroup,
        [x, y, z]: [u32; 3],
    ) {
        let found = self.pipelines.iter().find(|(name, _)| *name == entry_point);
        let Some((_, pipeline)) = found else { unreachable!("entry point {entry_point}") };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(x, y, z);
    }
}
