//! The viewer's renderer on a canvas.

use rockfall::glam::Vec3;
use rockfall::gpu::{Gpu, instance};
use rockfall::wgpu;
use rockfall_viewer::camera::{Camera, Direction};
use rockfall_viewer::draw::{Background, ColourBy, Renderer, Style};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use crate::errors::thrown;
use crate::scene::Scene;
use crate::simulation::Simulation;

/// Colours of the dark background.
const DARK: Background = Background { horizon: [0x1c, 0x20, 0x25], zenith: [0x2c, 0x35, 0x40] };

#[wasm_bindgen]
extern "C" {
    /// The format of a canvas that the browser shows without a copy.
    #[wasm_bindgen(js_namespace = ["navigator", "gpu"], js_name = getPreferredCanvasFormat)]
    fn preferred_format() -> String;
}

/// Draws a simulation onto a canvas with WebGPU.
#[wasm_bindgen]
pub struct View {
    surface: wgpu::Surface<'static>,
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Renderer,
    camera: Camera,
    style: Style,
    format: wgpu::TextureFormat,
    /// Whether only this view uses the device.
    owns: bool,
}

#[wasm_bindgen]
impl View {
    /// Creates a view of a simulation on a canvas of the page. The canvas must not have another context. A simulation on the CPU is
    /// drawn by a device of its own.
    ///
    /// Rejects for a simulation on the CPU if no hardware GPU can be opened. The canvas has no context then.
    pub async fn create(canvas: HtmlCanvasElement, scene: &Scene, simulation: &Simulation) -> Result<View, JsValue> {
        let shared = simulation.inner.gpu_view().map(|view| view.gpu().clone());
        let owns = shared.is_none();
        let gpu = match shared {
            Some(gpu) => gpu,
            None => Gpu::open(false).await.map_err(thrown)?,
        };
        let (device, queue) = (gpu.device().clone(), gpu.queue().clone());
        let (width, height) = (canvas.width(), canvas.height());
        let surface = instance()
            .create_surface(wgpu::SurfaceTarget::Canvas(canvas))
            .map_err(|error| js_sys::Error::new(&error.to_string()))?;
        // A preferred format is one of these two in WebGPU.
        let is_rgba = preferred_format() == "rgba8unorm";
        let format = if is_rgba { wgpu::TextureFormat::Rgba8Unorm } else { wgpu::TextureFormat::Bgra8Unorm };
        let mut renderer = Renderer::new(&device, &queue, format).map_err(thrown)?;
        renderer.set_scene(&simulation.inner);
        let camera = Camera::of_scene(&scene.inner, width as f32 / height.max(1) as f32, Direction::Oblique);
        let mut view = Self { surface, device, queue, renderer, camera, style: Style::default(), format, owns };
        view.resize(width, height);
        Ok(view)
    }

    /// Adapts the view to the size of the canvas, in pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        let most = self.device.limits().max_texture_dimension_2d;
        let (width, height) = (width.clamp(1, most), height.clamp(1, most));
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: self.format,
            color_space: wgpu::SurfaceColorSpace::default(),
            width,
            height,
            present_mode: wgpu::PresentMode::Fifo,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Opaque,
            view_formats: Vec::new(),
        };
        self.surface.configure(&self.device, &configuration);
        self.renderer.resize(width, height);
    }

    /// Sets the camera: x, y, z of the eye and of the point that it looks at, in units.
    #[wasm_bindgen(js_name = setCamera)]
    pub fn set_camera(&mut self, ex: f32, ey: f32, ez: f32, tx: f32, ty: f32, tz: f32) {
        (self.camera.eye, self.camera.target) = (Vec3::new(ex, ey, ez), Vec3::new(tx, ty, tz));
    }

    /// Sets a dark or a light background.
    #[wasm_bindgen(js_name = setDark)]
    pub fn set_dark(&mut self, dark: bool) {
        self.style.background = if dark { DARK } else { Background::default() };
    }

    /// Sets whether bodies cast shadows and corners are darkened. Without shadows, a slow GPU draws in less time.
    #[wasm_bindgen(js_name = setShadows)]
    pub fn set_shadows(&mut self, shadows: bool) {
        (self.style.shadows, self.style.occlusion) = (shadows, shadows);
    }

    /// Sets whether every body has a colour of its own, instead of the colour of its kind.
    #[wasm_bindgen(js_name = colourBodies)]
    pub fn colour_bodies(&mut self, each: bool) {
        self.style.colour_by = if each { ColourBy::Body } else { ColourBy::Kind };
    }

    /// Sets the colours of the spheres in insertion order: red, green, blue of each, from 0 to 255 in sRGB. Spheres that are not
    /// in the list keep their colours.
    #[wasm_bindgen(js_name = setColours)]
    pub fn set_colours(&mut self, colours: &[u8]) {
        self.renderer.set_colours(colours.chunks_exact(3).map(|rgb| Some([rgb[0], rgb[1], rgb[2]])).collect());
    }

    /// Draws the present state of the simulation that the view was created for.
    pub async fn draw(&mut self, simulation: &mut Simulation) -> Result<(), JsValue> {
        simulation.inner.flush_async().await.map_err(thrown)?;
        self.renderer.update(&mut simulation.inner, &self.style).map_err(thrown)?;
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            // The canvas is hidden or changes its size: the next frame is drawn again.
            _ => return Ok(()),
        };
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer.draw(&mut encoder, &target, &self.camera, &self.style);
        self.queue.submit([encoder.finish()]);
        self.queue.present(frame);
        Ok(())
    }
}

impl Drop for View {
    /// Releases the memory of the GPU at once. A browser would do so only when it collects garbage.
    fn drop(&mut self) {
        if self.owns {
            self.device.destroy();
        }
    }
}
