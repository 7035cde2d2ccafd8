//! Formats of the textures that a frame is drawn in.

use rockfall::wgpu;

/// Number of samples per pixel. `wgsl/frame.wgsl` has their positions.
pub(crate) const SAMPLES: u32 = 4;
/// Format of the colours before encoding: linear light.
pub(crate) const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depths: of the picture (1 on the near plane, 0 at infinity) and of the shadow map (0 nearest to the sun).
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of the openness to the sky of each pixel.
pub(crate) const OPENNESS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
