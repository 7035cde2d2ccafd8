//! Formats of the textures that a frame is drawn in.

use rockfall::wgpu;

/// Samples of a pixel. `wgsl/frame.wgsl` knows where they lie.
pub(crate) const SAMPLES: u32 = 4;
/// Linear light.
pub(crate) const LIGHT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Of the picture (1 on the near plane, 0 at infinity) and of the shadow map (0 next to the sun).
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// How open to the sky a pixel is.
pub(crate) const OPENNESS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
