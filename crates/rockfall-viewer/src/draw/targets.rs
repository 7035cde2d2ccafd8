//! The textures of a frame.

use rockfall::wgpu;

use crate::draw::formats::{DEPTH_FORMAT, LIGHT_FORMAT, OPENNESS_FORMAT, SAMPLES};
use crate::draw::layouts::Layouts;
use crate::draw::pyramid::{Pyramid, PyramidBuilder};

/// Number of pixels along a side of the shadow map.
pub(crate) const SHADOW_SIZE: u32 = 2048;

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

fn view(binding: u32, view: &wgpu::TextureView) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) }
}

fn colour(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

fn depth(view: &wgpu::TextureView, clear: f32) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

/// Begins a pass that draws onto a whole texture.
pub(crate) fn fill<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    view: &wgpu::TextureView,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(colour(view))],
        timestamp_writes,
        ..Default::default()
    })
}

/// Textures that have the size of the picture.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) size: [u32; 2],
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    light: wgpu::TextureView,
    pub(crate) openness: wgpu::TextureView,
    pub(crate) pyramid: Pyramid,
    /// Bind group of the ambient occlusion.
    pub(crate) occlusion: wgpu::BindGroup,
    /// Bind group of the last pass.
    pub(crate) finish: wgpu::BindGroup,
}

impl Targets {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts, builder: &PyramidBuilder, size: [u32; 2]) -> Self {
        let light = texture(device, "light", size, 1, LIGHT_FORMAT);
        let depth = texture(device, "depth", size, SAMPLES, DEPTH_FORMAT);
        let openness = texture(device, "openness", size, 1, OPENNESS_FORMAT);
        let group = |label, layout, entries: &[_]| {
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries })
        };
        Self {
            size,
            pyramid: Pyramid::new(device, builder, &depth, size),
            occlusion: group("occlusion", &layouts.occlusion, &[view(0, &depth)]),
            finish: group("finish", &layouts.finish, &[view(0, &light), view(1, &openness), view(2, &depth)]),
            samples: texture(device, "samples of light", size, SAMPLES, LIGHT_FORMAT),
            depth,
            light,
            openness,
        }
    }

    /// Begins a pass that draws bodies.
    pub(crate) fn bodies<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        which: Bodies,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'a> {
        let mut samples = colour(&self.samples);
        let mut depth = depth(&self.depth, 0.0);
        if which != Bodies::First {
            (samples.resolve_target, samples.ops.store) = (Some(&self.light), wgpu::StoreOp::Discard);
        }
        if which == Bodies::Second {
            samples.ops.load = wgpu::LoadOp::Load;
            depth.depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store });
        }
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("bodies"),
            color_attachments: &[Some(samples)],
            depth_stencil_attachment: Some(depth),
            timestamp_writes,
            ..Default::default()
        })
    }
}

/// One of the passes that draw bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bodies {
    /// The only pass, which draws all bodies.
    All,
    /// The first of two passes: bodies that were visible in the last frame.
    First,
    /// The second of two passes: bodies that the first pass does not hide.
    Second,
}

/// The shadow map: depths seen from the sun.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    depth: wgpu::TextureView,
    /// Bind group of lit surfaces.
    pub(crate) group: wgpu::BindGroup,
}

impl ShadowMap {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let depth = texture(device, "shadows", [SHADOW_SIZE; 2], 1, DEPTH_FORMAT);
        let nearer = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadows"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let entries = [view(0, &depth), wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&nearer) }];
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shadows"),
            layout: &layouts.shadows,
            entries: &entries,
        });
        Self { depth, group }
    }

    pub(crate) fn pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(depth(&self.depth, 1.0)),
            timestamp_writes,
            ..Default::default()
        })
    }
}
