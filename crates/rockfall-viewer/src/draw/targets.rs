//! The textures that a frame is made in.

use rockfall::wgpu;

use crate::draw::pipelines::Layouts;

/// Samples of a pixel. `wgsl/frame.wgsl` knows where they lie.
pub(crate) const SAMPLES: u32 = 4;
/// Linear light.
pub(crate) const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Textures of the size of the picture.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) size: [u32; 2],
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    light: wgpu::TextureView,
    /// What the last pass reads.
    pub(crate) group: wgpu::BindGroup,
}

fn texture(device: &wgpu::Device, label: &str, size: [u32; 2], samples: u32, format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl Targets {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts, size: [u32; 2]) -> Self {
        let light = texture(device, "light", size, 1, LIGHT_FORMAT);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("finish"),
            layout: &layouts.finish,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&light) }],
        });
        Self {
            size,
            samples: texture(device, "samples of light", size, SAMPLES, LIGHT_FORMAT),
            depth: texture(device, "depth", size, SAMPLES, DEPTH_FORMAT),
            light,
            group,
        }
    }

    /// The pass that draws bodies.
    pub(crate) fn light_pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, background: [f32; 3]) -> wgpu::RenderPass<'a> {
        let [r, g, b] = background.map(f64::from);
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("bodies"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(&self.light),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    /// A pass that fills the caller's texture.
    pub(crate) fn onto<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, view: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("finish"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        })
    }
}
