//! The graphics device of the window. Draws the scene into a texture and the widgets around it.

use std::sync::{Arc, Mutex, PoisonError};

use egui_wgpu::ScreenDescriptor;
use rockfall::{Backend, Error, Options, Result, Scene, Simulation, wgpu};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::session::Opener;
use crate::camera::Camera;
use crate::draw::{Renderer, Style};
use crate::pixels::Picture as Pixels;
use crate::read_back::read_back;

/// Format of the picture of the scene, which the renderer of the widgets shows without conversion.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The first error of the device that no call has returned.
#[derive(Clone, Debug, Default)]
struct Faults(Arc<Mutex<Option<String>>>);

impl Faults {
    fn record(&self, text: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
    }

    fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The device and everything on it.
pub(super) struct Graphics {
    device: wgpu::Device,
    queue: wgpu::Queue,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    faults: Faults,
    widgets: egui_wgpu::Renderer,
    /// Draws the scene.
    pub(super) renderer: Renderer,
    pub(super) picture: Option<Picture>,
    software: bool,
    /// Name of the device.
    pub(super) name: String,
}

/// The texture that the scene is drawn onto.
pub(super) struct Picture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    id: egui::TextureId,
    /// Width and height, in pixels.
    pub(super) size: [u32; 2],
}

fn device_error(error: impl std::fmt::Display) -> Error {
    Error::Device(error.to_string())
}

impl Graphics {
    /// Opens the most powerful device that can draw onto a window.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] if there is none, [`Error::Device`] if it cannot be opened.
    pub(super) fn open(window: &Arc<Window>, display: OwnedDisplayHandle) -> Result<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display)));
        let surface = instance.create_surface(Arc::clone(window)).map_err(device_error)?;
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .map_err(|error| Error::NoAdapter(format!("none can draw onto this window: {error}")))?;
        let timing = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("rockfall view"),
            required_features: adapter.features() & timing,
            required_limits: adapter.limits(),
            ..Default::default()
        }))
        .map_err(device_error)?;
        let faults = watch(&device);
        let config = configuration(&surface, &adapter, window)?;
        surface.configure(&device, &config);
        let info = adapter.get_info();
        Ok(Self {
            widgets: egui_wgpu::Renderer::new(&device, config.format, egui_wgpu::RendererOptions::default()),
            renderer: Renderer::new(&device, &queue, PICTURE_FORMAT)?,
            surface,
            config,
            faults,
            picture: None,
            software: info.device_type == wgpu::DeviceType::Cpu,
            name: format!("{} ({})", info.name, info.backend),
            device,
            queue,
        })
    }

    /// Returns the function that opens scenes: on this device, or on the CPU backend if the options request it or if the
    /// device is a software implementation.
    pub(super) fn opener(&self, options: &Options) -> Opener {
        let on_cpu = match options.backend {
            Backend::Cpu => true,
            Backend::Gpu => false,
            Backend::Auto => self.software,
        };
        let (device, queue, options) = (self.device.clone(), self.queue.clone(), options.clone());
        Box::new(move |scene: Scene| {
            if on_cpu {
                return Simulation::with_options(scene, options.clone().backend(Backend::Cpu));
            }
            let mut simulation = Simulation::on_device(scene, options.clone(), &device, &queue)?;
            // Kernels are compiled now, because compiling them during a run would interrupt the motion.
            simulation.prepare()?;
            Ok(simulation)
        })
    }

    /// Returns the first error since the last call.
    pub(super) fn fault(&self) -> Option<String> {
        self.faults.take()
    }

    /// Destroys the device like a failing driver does, for tests.
    pub(super) fn lose(&self) {
        self.device.destroy();
        self.faults.record("the device was lost on purpose".to_owned());
    }

    /// Sets the size of the window.
    pub(super) fn resize(&mut self, width: u32, height: u32) {
        let most = self.device.limits().max_texture_dimension_2d;
        (self.config.width, self.config.height) = (width.clamp(1, most), height.clamp(1, most));
        self.surface.configure(&self.device, &self.config);
    }

    /// Returns the texture of the scene for a size on the screen. A software device draws moving scenes at half the resolution,
    /// because it would be too slow otherwise.
    pub(super) fn picture(&mut self, size: [u32; 2], moving: bool) -> egui::TextureId {
        let most = self.device.limits().max_texture_dimension_2d;
        let coarse = if self.software && moving { 2 } else { 1 };
        let size = size.map(|side| (side / coarse).clamp(1, most));
        if let Some(picture) = self.picture.as_ref().filter(|picture| picture.size == size) {
            return picture.id;
        }
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PICTURE_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let smooth = wgpu::FilterMode::Linear;
        let id = match self.picture.take() {
            Some(old) => {
                self.widgets.update_egui_texture_from_wgpu_texture(&self.device, &view, smooth, old.id);
                old.id
            }
            None => self.widgets.register_native_texture(&self.device, &view, smooth),
        };
        self.renderer.resize(size[0], size[1]);
        self.picture = Some(Picture { texture, view, id, size });
        id
    }

    /// Draws the scene if it changed, draws the widgets, and presents both.
    pub(super) fn show(&mut self, window: &Window, scene: Option<(&Camera, &Style)>, widgets: Widgets) {
        let Widgets { primitives, mut textures, pixels_per_point } = widgets;
        for (id, deltas) in &textures.set {
            for delta in deltas {
                self.widgets.update_texture(&self.device, &self.queue, *id, delta);
            }
        }
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if let (Some((camera, style)), Some(picture)) = (scene, &self.picture) {
            self.renderer.draw(&mut encoder, &picture.view, camera, style);
        }
        let surface = self.acquire();
        let mut commands = Vec::new();
        if let Some(surface) = &surface {
            let screen = ScreenDescriptor { size_in_pixels: [self.config.width, self.config.height], pixels_per_point };
            commands = self.widgets.update_buffers(&self.device, &self.queue, &mut encoder, &primitives, &screen);
            let view = surface.texture.create_view(&wgpu::TextureViewDescriptor::default());
            let mut pass = widgets_pass(&mut encoder, &view).forget_lifetime();
            self.widgets.render(&mut pass, &primitives, &screen);
        }
        commands.push(encoder.finish());
        self.queue.submit(commands);
        if let Some(surface) = surface {
            window.pre_present_notify();
            self.queue.present(surface);
        }
        for id in &textures.free {
            self.widgets.free_texture(id);
        }
        // egui requires that handled changes are cleared.
        textures.clear();
    }

    /// Reads the last picture of the scene back.
    ///
    /// # Errors
    /// [`Error::Device`] when the device failed or no picture was drawn yet.
    pub(super) fn read_picture(&self) -> Result<Pixels> {
        let picture = self.picture.as_ref().ok_or_else(|| Error::Device("there is no picture yet".to_owned()))?;
        let [width, height] = picture.size;
        let stride = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(stride) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(stride), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
        encoder.copy_texture_to_buffer(picture.texture.as_image_copy(), to, picture.texture.size());
        self.queue.submit([encoder.finish()]);
        let pixels = read_back(&self.device, &staging, |bytes| {
            let rows = bytes.chunks_exact(stride as usize).map(|row| &row[..4 * width as usize]);
            rows.flat_map(|row| row.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]])).collect()
        })?;
        Ok(Pixels { width, height, pixels })
    }

    /// Returns the next texture of the window; `None` while the window is not visible.
    fn acquire(&mut self) -> Option<wgpu::SurfaceTexture> {
        use wgpu::CurrentSurfaceTexture as Got;
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                Got::Success(texture) | Got::Suboptimal(texture) => return Some(texture),
                Got::Outdated | Got::Lost => self.surface.configure(&self.device, &self.config),
                Got::Timeout | Got::Occluded | Got::Validation => return None,
            }
        }
        None
    }
}

/// The widgets of a frame, as triangles.
pub(super) struct Widgets {
    pub(super) primitives: Vec<egui::ClippedPrimitive>,
    pub(super) textures: egui::TexturesDelta,
    pub(super) pixels_per_point: f32,
}

fn widgets_pass<'a>(encoder: &'a mut wgpu::CommandEncoder, view: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("widgets"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}

/// Records uncaptured errors and the loss of the device, which would otherwise end the program.
fn watch(device: &wgpu::Device) -> Faults {
    let faults = Faults::default();
    let at_error = faults.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| at_error.record(error.to_string())));
    let at_loss = faults.clone();
    device.set_device_lost_callback(move |reason, message| {
        at_loss.record(format!("the device was lost ({reason:?}): {message}"));
    });
    faults
}

/// Returns the configuration of the surface: synchronised with the screen, and if possible in a format without sRGB encoding,
/// because the renderer of the widgets encodes by itself.
fn configuration(surface: &wgpu::Surface, adapter: &wgpu::Adapter, window: &Window) -> Result<wgpu::SurfaceConfiguration> {
    let size = window.inner_size();
    let mut config = surface
        .get_default_config(adapter, size.width.max(1), size.height.max(1))
        .ok_or_else(|| Error::NoAdapter("the adapter cannot draw onto this window".to_owned()))?;
    let formats = surface.get_capabilities(adapter).formats;
    let encoded =
        formats.iter().find(|format| matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm));
    config.format = encoded.copied().unwrap_or(config.format);
    config.present_mode = wgpu::PresentMode::AutoVsync;
    Ok(config)
}
