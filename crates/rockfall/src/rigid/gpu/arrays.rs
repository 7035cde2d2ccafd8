//! The arrays of a frame on a device by binding, and dispatches over them.

use std::sync::{Arc, OnceLock};

use bytemuck::Pod;

use crate::rigid::gpu::kernels::{ADD_LAWS, BINDINGS, Kernel, Kinds, STAGES};
use crate::rigid::gpu::{MOST_GROUPS, RigidGpu, THREADS};

/// Arrays by binding, and a bind group for each stage that was used.
#[derive(Debug)]
pub(super) struct Arrays {
    pub(super) gpu: Arc<RigidGpu>,
    /// Kinds of shapes of the scene.
    pub(super) kinds: Kinds,
    buffers: Vec<Option<wgpu::Buffer>>,
    groups: Vec<OnceLock<wgpu::BindGroup>>,
    /// The kernel with the forces of the program.
    pub(super) laws: Option<Kernel>,
}

impl Arrays {
    pub(super) fn new(gpu: Arc<RigidGpu>, kinds: Kinds) -> Self {
        let groups = STAGES.iter().map(|_| OnceLock::new()).collect();
        Self { gpu, kinds, buffers: vec![None; BINDINGS as usize], groups, laws: None }
    }

    /// No arrays yet, of the same scene.
    pub(super) fn beside(&self) -> Self {
        Self::new(Arc::clone(&self.gpu), self.kinds)
    }

    pub(super) fn get(&self, binding: u32) -> &wgpu::Buffer {
        self.buffers[binding as usize].as_ref().expect("an array of the frame")
    }

    /// An array of so many bytes with undefined contents.
    pub(super) fn make(&mut self, binding: u32, bytes: u64) {
        self.put(binding, self.gpu.storage(bytes));
    }

    /// An array with these contents.
    pub(super) fn upload(&mut self, binding: u32, bytes: &[u8]) {
        self.make(binding, bytes.len() as u64);
        self.gpu.queue.write_buffer(self.get(binding), 0, bytes);
    }

    /// A uniform block.
    pub(super) fn upload_uniform(&mut self, binding: u32, bytes: &[u8]) {
        let buffer = self.gpu.buffer("rigid", bytes.len() as u64, wgpu::BufferUsages::UNIFORM);
        self.gpu.queue.write_buffer(&buffer, 0, bytes);
        self.put(binding, buffer);
    }

    pub(super) fn put(&mut self, binding: u32, buffer: wgpu::Buffer) {
        self.buffers[binding as usize] = Some(buffer);
        for (group, stage) in self.groups.iter_mut().zip(STAGES) {
            if binding < 2 || stage.bindings.contains(&binding) {
                group.take();
            }
        }
    }

    fn kernel(&self, stage: usize) -> &Kernel {
        match &self.laws {
            Some(kernel) if stage == ADD_LAWS => kernel,
            _ => self.gpu.kernel(stage, self.kinds),
        }
    }

    fn group(&self, stage: usize) -> &wgpu::BindGroup {
        self.groups[stage].get_or_init(|| {
            let call = wgpu::BufferBinding { buffer: self.get(1), offset: 0, size: wgpu::BufferSize::new(8) };
            let mut entries = vec![
                wgpu::BindGroupEntry { binding: 0, resource: self.get(0).as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Buffer(call) },
            ];
            let entry =
                |binding: &u32| wgpu::BindGroupEntry { binding: *binding, resource: self.get(*binding).as_entire_binding() };
            entries.extend(STAGES[stage].bindings.iter().map(entry));
            let layout = &self.kernel(stage).layout;
            self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        })
    }

    /// A dispatch of at least so many threads; none for 0. `offset` is that of the call in its uniform block.
    pub(super) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, stage: usize, threads: u32, offset: u32) {
        self.dispatch_groups(pass, stage, threads.div_ceil(THREADS), offset);
    }

    /// A dispatch of at least so many workgroups.
    pub(super) fn dispatch_groups(&self, pass: &mut wgpu::ComputePass<'_>, stage: usize, groups: u32, offset: u32) {
        if groups == 0 {
            return;
        }
        let rows = groups.div_ceil(MOST_GROUPS);
        pass.set_pipeline(&self.kernel(stage).pipeline);
        pass.set_bind_group(0, self.group(stage), &[offset]);
        pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
    }

    /// Waits for the device and reads the start of an array.
    ///
    /// # Errors
    /// What the device says if it is lost.
    pub(super) fn read<T: Pod>(&self, binding: u32, count: u32) -> Result<Vec<T>, String> {
        let size = u64::from(count) * size_of::<T>() as u64;
        if size == 0 {
            return Ok(Vec::new());
        }
        let staging = self.gpu.buffer("rigid read", size, wgpu::BufferUsages::MAP_READ);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(self.get(binding), 0, &staging, 0, size);
        self.gpu.submit_and_read(encoder, &staging, size)
    }
}
