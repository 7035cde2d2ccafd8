//! Drawing a simulation, straight from the buffers that the physics runs on.
//!
//! On the GPU backend no body passes through the host: the shaders read state, orientations and topology where the kernels
//! left them. On the CPU backend the same arrays are uploaded, so that there is one set of shaders. See [`Renderer`].

use rockfall::glam::Vec4;
use rockfall::layout::Step;
use rockfall::wgpu;
use rockfall::{Result, Simulation};

use crate::camera::Camera;

mod bounds;
mod frame;
pub mod palette;
mod pipelines;
mod source;
mod style;
mod targets;

pub use bounds::bounds;
use frame::Frame;
use pipelines::{Layouts, Pipelines};
use source::Source;
pub use style::{ColourBy, Range, Style};
use targets::Targets;

/// Draws a simulation onto any texture of one format.
///
/// ```no_run
/// # fn main() -> rockfall::Result<()> {
/// # use rockfall::{wgpu, Scene, Simulation};
/// # use rockfall_viewer::{camera::Camera, draw::{Renderer, Style}};
/// # let (device, queue, mut simulation, target): (wgpu::Device, wgpu::Queue, Simulation, wgpu::TextureView) = todo!();
/// let mut renderer = Renderer::new(&device, &queue, wgpu::TextureFormat::Bgra8Unorm);
/// renderer.resize(800, 600);
/// let camera = Camera::of_scene(simulation.scene(), 800.0 / 600.0);
/// // For every frame:
/// simulation.step(0.02)?;
/// renderer.update(&mut simulation, &Style::default())?;
/// let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
/// renderer.draw(&mut encoder, &target, &camera, &Style::default());
/// queue.submit([encoder.finish()]);
/// # Ok(())
/// # }
/// ```
///
/// The device must be the one that the simulation runs on, where that is a GPU
/// (`simulation.gpu_view()` gives it; [`Simulation::on_device`] takes the caller's), opened with all limits of its adapter:
/// WebGPU's defaults are too small for large scenes.
#[derive(Debug)]
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layouts: Layouts,
    pipelines: Pipelines,
    uniform: wgpu::Buffer,
    source: Source,
    targets: Option<Targets>,
    step: Step,
    blend: f32,
}

impl Renderer {
    /// A renderer for textures of this format.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: size_of::<Frame>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            device: device.clone(),
            queue: queue.clone(),
            pipelines: Pipelines::new(device, &layouts, format),
            layouts,
            uniform,
            source: Source::default(),
            targets: None,
            step: Step::default(),
            blend: 1.0,
        }
    }

    /// Sets the size of what is drawn onto, in pixels; at least 1, at most the device's `max_texture_dimension_2d`.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = [width.max(1), height.max(1)];
        if self.targets.as_ref().is_none_or(|targets| targets.size != size) {
            self.targets = Some(Targets::new(&self.device, &self.layouts, size));
        }
    }

    /// Takes in which rods and spheres are capsules. [`Renderer::update`] does so by itself where objects were added or
    /// removed; this is for another simulation.
    pub fn set_scene(&mut self, simulation: &Simulation) {
        self.source.mark_capsules(&self.device, &self.queue, simulation);
        self.blend = 1.0;
    }

    /// Takes in the simulation as it is now. On the GPU backend that is where its buffers are, and nothing is copied; on the
    /// CPU backend the state is uploaded. What [`Style::colour_by`] asks for beyond the state is evaluated on the host.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the GPU failed.
    pub fn update(&mut self, simulation: &mut Simulation, style: &Style) -> Result<()> {
        simulation.flush()?;
        if self.source.is_stale(simulation) {
            self.set_scene(simulation);
        }
        self.step = self.source.take(&self.device, &self.queue, simulation);
        if style.colour_by.is_evaluated() {
            let values = simulation.diagnostics()?;
            self.source.set_values(&self.queue, simulation, values.iter().map(|value| style.colour_by.of(value)));
        }
        self.source.bind(&self.device, &self.layouts.bodies, &self.uniform);
        Ok(())
    }

    /// Keeps the positions and orientations that [`Renderer::update`] took in last, on the device, as the ones to blend
    /// from.
    pub fn remember(&mut self) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.source.remember(&mut encoder, self.step.spheres);
        self.queue.submit([encoder.finish()]);
    }

    /// From the next [`Renderer::draw`] on, bodies are shown between where they were when [`Renderer::remember`] was
    /// called, 0, and where they are, 1. Where spheres were put in another order since, they are shown where they are.
    pub fn set_blend(&mut self, blend: f32) {
        self.blend = blend.clamp(0.0, 1.0);
    }

    /// Draws onto `target`, whole, what [`Renderer::update`] took in last. The size must be that of [`Renderer::resize`].
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, camera: &Camera, style: &Style) {
        let (Some(targets), Some(bodies)) = (&self.targets, &self.source.group) else {
            return;
        };
        let blend = if self.source.has_remembered() { self.blend } else { 1.0 };
        let frame = Frame::new(&self.step, camera, style, targets.size, blend);
        self.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&frame));
        self.draw_bodies(encoder, targets, bodies, style);
        let mut pass = targets.onto(encoder, target);
        pass.set_bind_group(0, bodies, &[]);
        pass.set_bind_group(1, &targets.group, &[]);
        pass.set_pipeline(&self.pipelines.finish);
        pass.draw(0..3, 0..1);
    }

    fn draw_bodies(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, bodies: &wgpu::BindGroup, style: &Style) {
        let mut pass = targets.light_pass(encoder, palette::linear(style.background.horizon));
        pass.set_bind_group(0, bodies, &[]);
        pass.set_pipeline(&self.pipelines.spheres);
        pass.draw(0..4, 0..self.step.spheres);
    }
}

fn opaque(colour: [f32; 3]) -> Vec4 {
    Vec4::new(colour[0], colour[1], colour[2], 1.0)
}
