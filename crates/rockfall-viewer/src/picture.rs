//! Pictures that are drawn without a window.

use rockfall::exec::gpu::catch;
use rockfall::{Error, Result, wgpu};

use crate::camera::Camera;
use crate::draw::{Renderer, Style};
pub use crate::pixels::Picture;
use crate::read_back::read_back;

/// Format of the texture of a [`Canvas`].
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A texture to draw on, and a buffer to read it back with.
#[derive(Debug)]
pub struct Canvas {
    device: wgpu::Device,
    queue: wgpu::Queue,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    staging: wgpu::Buffer,
    stride: u32,
}

impl Canvas {
    /// Creates a canvas; `width` and `height` are in pixels.
    ///
    /// # Errors
    /// [`Error::PictureSize`] when a side is 0 or larger than the device allows; [`Error::Device`] when memory runs out.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, width: u32, height: u32) -> Result<Self> {
        let limit = device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(Error::PictureSize { width, height, limit });
        }
        catch(device, || Self::make(device, queue, width, height))
    }

    fn make(device: &wgpu::Device, queue: &wgpu::Queue, width: u32, height: u32) -> Self {
        let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("canvas"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(stride) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { device: device.clone(), queue: queue.clone(), texture, view, staging, stride }
    }

    /// Draws the state of the last [`Renderer::update`]; the picture stays on the device.
    ///
    /// # Errors
    /// [`Error::Device`] when the device failed.
    pub fn draw(&self, renderer: &mut Renderer, camera: &Camera, style: &Style) -> Result<()> {
        catch(&self.device, || {
            renderer.resize(self.texture.width(), self.texture.height());
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            renderer.draw(&mut encoder, &self.view, camera, style);
            self.queue.submit([encoder.finish()]);
        })
    }

    /// Draws the state of the last [`Renderer::update`] and reads the picture back.
    ///
    /// # Errors
    /// [`Error::Device`] when the device failed.
    pub fn take(&self, renderer: &mut Renderer, camera: &Camera, style: &Style) -> Result<Picture> {
        self.draw(renderer, camera, style)?;
        catch(&self.device, || {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.stride), rows_per_image: None };
            encoder.copy_texture_to_buffer(
                self.texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: &self.staging, layout },
                self.texture.size(),
            );
            self.queue.submit([encoder.finish()]);
        })?;
        let (width, height) = (self.texture.width(), self.texture.height());
        Ok(Picture { width, height, pixels: self.read()? })
    }

    fn read(&self) -> Result<Vec<[u8; 4]>> {
        let row = 4 * self.texture.width() as usize;
        read_back(&self.device, &self.staging, |bytes| {
            let rows = bytes.chunks_exact(self.stride as usize).map(|line| &line[..row]);
            rows.flat_map(|line| line.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]])).collect()
        })
    }
}
