//! The render pipelines, and the shader text that they are compiled from.

use rockfall::wgpu;
use wgpu::PrimitiveTopology::{TriangleList, TriangleStrip};

use crate::draw::chains::CHAINS;
use crate::draw::formats::{DEPTH_FORMAT, LIGHT_FORMAT, OPENNESS_FORMAT, SAMPLES};
use crate::draw::joints::STRINGS;
use crate::draw::layouts::Layouts;

macro_rules! wgsl {
    ($($name:literal),*) => { concat!($(include_str!(concat!("wgsl/", $name, ".wgsl"))),*) };
}

/// Shaders that draw bodies and their shadows.
pub(crate) const BODIES: &str = wgsl!(
    "frame", "colour", "look", "light", "surface", "sphere", "capsule", "flat", "far", "coil", "string", "chain", "picture",
    "ground", "shadow"
);
/// Shaders that select the spheres to draw.
pub(crate) const CULL: &str = wgsl!("frame", "colour", "look", "cull");
/// Shader of the ambient occlusion.
pub(crate) const OCCLUSION: &str = wgsl!("frame", "picture", "occlusion");
/// Shader that writes the final picture.
pub(crate) const FINISH: &str = wgsl!("frame", "picture", "finish");

/// The target of a pipeline, with its depth test and blending.
#[derive(Clone, Copy, Debug)]
enum RenderTarget {
    /// The multisampled light, with depth.
    Bodies,
    /// The same, behind all bodies.
    Sky,
    /// The same, blended over the bodies, with depth test.
    Ground,
    /// The same, blended over the bodies, with depth test but without writing depth: edges and glass.
    Edges,
    /// The same with a constant opacity.
    Panes,
    /// The same, over everything, without depth test.
    Chains,
    /// The shadow map.
    Shadows,
    /// A texture without depth.
    Texture(wgpu::TextureFormat),
}

/// The pipelines of one kind of object.
#[derive(Debug)]
pub(crate) struct Kind {
    pub(crate) lit: wgpu::RenderPipeline,
    pub(crate) shadow: wgpu::RenderPipeline,
}

/// All render pipelines.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) spheres: Kind,
    pub(crate) far: wgpu::RenderPipeline,
    pub(crate) capsules: Kind,
    pub(crate) boxes: Kind,
    /// Boxes of rigid bodies.
    pub(crate) blocks: Kind,
    pub(crate) polygons: Kind,
    pub(crate) springs: Kind,
    pub(crate) tethers: Kind,
    pub(crate) anchors: Kind,
    /// Distance joints.
    pub(crate) strings: Kind,
    pub(crate) sky: wgpu::RenderPipeline,
    pub(crate) ground: wgpu::RenderPipeline,
    /// The faces and the edges of boxes and polygons that hide bodies.
    pub(crate) hiding_boxes: [wgpu::RenderPipeline; 2],
    pub(crate) hiding_polygons: [wgpu::RenderPipeline; 2],
    pub(crate) chains: wgpu::RenderPipeline,
    /// Spheres of glass.
    pub(crate) glass_spheres: wgpu::RenderPipeline,
    /// Capsules, boxes and polygons of glass.
    pub(crate) glass: [wgpu::RenderPipeline; 4],
    pub(crate) occlusion: wgpu::RenderPipeline,
    pub(crate) finish: wgpu::RenderPipeline,
}

#[derive(Clone)]
struct PipelineBuilder<'a> {
    device: &'a wgpu::Device,
    module: wgpu::ShaderModule,
    layouts: Vec<Option<&'a wgpu::BindGroupLayout>>,
    constants: &'a [(&'a str, f64)],
    /// The vertex buffer of the instances.
    instances: Option<wgpu::VertexBufferLayout<'a>>,
}

/// Vertex buffer with the memory slots of a list of spheres, one per instance.
const SLOTS: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: 4,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &[wgpu::VertexAttribute { format: wgpu::VertexFormat::Uint32, offset: 0, shader_location: 0 }],
};

impl<'a> PipelineBuilder<'a> {
    fn new(
        device: &'a wgpu::Device,
        label: &str,
        text: &str,
        layouts: &[&'a wgpu::BindGroupLayout],
        constants: &'a [(&'a str, f64)],
    ) -> Self {
        let source = wgpu::ShaderSource::Wgsl(text.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(label), source });
        Self { device, module, layouts: layouts.iter().map(|layout| Some(*layout)).collect(), constants, instances: None }
    }

    fn make(
        &self,
        render_target: RenderTarget,
        topology: wgpu::PrimitiveTopology,
        vertex: &str,
        fragment: Option<&str>,
    ) -> wgpu::RenderPipeline {
        let layouts =
            if matches!(render_target, RenderTarget::Shadows | RenderTarget::Sky) { &self.layouts[..1] } else { &self.layouts };
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(vertex),
            bind_group_layouts: layouts,
            immediate_size: 0,
        });
        let compilation_options = wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        let target = render_target.colour();
        let instances = self.instances.clone().map(Some);
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment.unwrap_or(vertex)),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: compilation_options.clone(),
                buffers: instances.as_slice(),
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: render_target.depth(),
            multisample: wgpu::MultisampleState { count: render_target.samples(), ..Default::default() },
            fragment: fragment.map(|entry| wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(entry),
                compilation_options,
                targets: target.as_slice(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    /// Creates the pipelines of a kind with the entry points `NAME_vertex`, `SURFACE_surface`, `NAME_shadow_vertex` and, if
    /// each pixel of its shadow computes its depth (`has_depth`), `SURFACE_shadow`.
    fn kind(&self, topology: wgpu::PrimitiveTopology, name: &str, surface: &str, has_depth: bool) -> Kind {
        let shadow = has_depth.then(|| format!("{surface}_shadow"));
        Kind {
            lit: self.make(RenderTarget::Bodies, topology, &format!("{name}_vertex"), Some(&format!("{surface}_surface"))),
            shadow: self.make(RenderTarget::Shadows, topology, &format!("{name}_shadow_vertex"), shadow.as_deref()),
        }
    }
}

/// Shows what lies behind through an opaque surface. The constant is the opacity.
const PANE: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Constant,
    dst_factor: wgpu::BlendFactor::OneMinusConstant,
    operation: wgpu::BlendOperation::Add,
};

impl RenderTarget {
    fn colour(self) -> Option<Option<wgpu::ColorTargetState>> {
        match self {
            Self::Bodies | Self::Sky => Some(Some(LIGHT_FORMAT.into())),
            Self::Ground | Self::Edges | Self::Chains => Some(Some(wgpu::ColorTargetState {
                format: LIGHT_FORMAT,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })),
            Self::Panes => Some(Some(wgpu::ColorTargetState {
                format: LIGHT_FORMAT,
                blend: Some(wgpu::BlendState { color: PANE, alpha: PANE }),
                write_mask: wgpu::ColorWrites::ALL,
            })),
            Self::Shadows => None,
            Self::Texture(format) => Some(Some(format.into())),
        }
    }

    fn samples(self) -> u32 {
        if matches!(self, Self::Shadows | Self::Texture(_)) { 1 } else { SAMPLES }
    }

    fn depth(self) -> Option<wgpu::DepthStencilState> {
        let compare = match self {
            Self::Bodies | Self::Ground | Self::Edges | Self::Panes => wgpu::CompareFunction::Greater,
            Self::Sky | Self::Chains => wgpu::CompareFunction::Always,
            Self::Shadows => wgpu::CompareFunction::Less,
            Self::Texture(_) => return None,
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(!matches!(self, Self::Sky | Self::Edges | Self::Panes | Self::Chains)),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, layouts: &Layouts, format: wgpu::TextureFormat) -> Self {
        let bodies = PipelineBuilder::new(device, "bodies", BODIES, &[&layouts.bodies, &layouts.shadows], &[]);
        let listed = PipelineBuilder { instances: Some(SLOTS), ..bodies.clone() };
        let chained = PipelineBuilder { instances: Some(CHAINS), ..bodies.clone() };
        let strung = PipelineBuilder { instances: Some(STRINGS), ..bodies.clone() };
        let occlusion = PipelineBuilder::new(device, "occlusion", OCCLUSION, &[&layouts.bodies, &layouts.occlusion], &[]);
        let encodes = [("ENCODES", f64::from(u8::from(format.is_srgb())))];
        let finish = PipelineBuilder::new(device, "finish", FINISH, &[&layouts.bodies, &layouts.finish], &encodes);
        let glass = |topology, name: &str, surface: &str| {
            bodies.make(RenderTarget::Edges, topology, &format!("glass_{name}_vertex"), Some(&format!("{surface}_surface")))
        };
        let hiding = |name: &str| {
            let surfaces =
                [(RenderTarget::Panes, format!("{name}_surface")), (RenderTarget::Edges, "edges_surface".to_owned())];
            let vertex = format!("{name}_edges_vertex");
            surfaces.map(|(target, surface)| bodies.make(target, TriangleList, &vertex, Some(&surface)))
        };
        Self {
            glass_spheres: listed.make(RenderTarget::Edges, TriangleStrip, "glass_sphere_vertex", Some("sphere_surface")),
            glass: [
                glass(TriangleStrip, "capsule", "capsule"),
                glass(TriangleList, "box", "box"),
                glass(TriangleList, "polygon", "polygon"),
                glass(TriangleList, "block", "box"),
            ],
            spheres: listed.kind(TriangleStrip, "sphere", "sphere", true),
            far: listed.make(RenderTarget::Bodies, TriangleStrip, "far_vertex", Some("far_surface")),
            capsules: bodies.kind(TriangleStrip, "capsule", "capsule", true),
            boxes: bodies.kind(TriangleList, "box", "box", true),
            blocks: bodies.kind(TriangleList, "block", "box", true),
            polygons: bodies.kind(TriangleList, "polygon", "polygon", true),
            springs: bodies.kind(TriangleList, "spring", "coil", false),
            tethers: bodies.kind(TriangleList, "tether", "coil", false),
            anchors: bodies.kind(TriangleStrip, "anchor", "sphere", true),
            strings: strung.kind(TriangleStrip, "string", "string", false),
            sky: bodies.make(RenderTarget::Sky, TriangleList, "whole_picture", Some("sky")),
            ground: bodies.make(RenderTarget::Ground, TriangleList, "whole_picture", Some("ground")),
            hiding_boxes: hiding("box"),
            hiding_polygons: hiding("polygon"),
            chains: chained.make(RenderTarget::Chains, TriangleStrip, "chain_vertex", Some("chain_surface")),
            occlusion: occlusion.make(RenderTarget::Texture(OPENNESS_FORMAT), TriangleList, "whole_picture", Some("occlusion")),
            finish: finish.make(RenderTarget::Texture(format), TriangleList, "whole_picture", Some("finish")),
        }
    }
}
