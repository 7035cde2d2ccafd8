//! The strings of distance joints.

use rockfall::glam::Vec3;
use rockfall::wgpu;

/// Vertex buffer with the ends of a string per instance.
pub(crate) const STRINGS: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
};

/// The strings of a picture in a vertex buffer.
#[derive(Debug, Default)]
pub(crate) struct Strings {
    buffer: Option<wgpu::Buffer>,
    count: u32,
}

impl Strings {
    /// Uploads the ends.
    pub(crate) fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, ends: &[[Vec3; 2]]) {
        self.count = ends.len() as u32;
        let numbers: Vec<f32> = ends.iter().flatten().flat_map(|end| end.to_array()).collect();
        let size = size_of_val(numbers.as_slice()) as u64;
        if size == 0 {
            return;
        }
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some("strings"), size, usage, mapped_at_creation: false };
        let kept = self.buffer.take().filter(|buffer| buffer.size() >= size);
        let buffer = kept.unwrap_or_else(|| device.create_buffer(&descriptor));
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&numbers));
        self.buffer = Some(buffer);
    }

    /// Draws them with a pipeline.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        if let Some(buffer) = self.buffer.as_ref().filter(|_| self.count > 0) {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..4, 0..self.count);
        }
    }
}
