//! Drawing a simulation, straight from the buffers that the physics runs on.
//!
//! On the GPU backend no body passes through the host: the shaders read state, orientations and topology where the kernels
//! left them. On the CPU backend the same arrays are uploaded, so that there is one set of shaders. See [`Renderer`].

use rockfall::gpu::catch;
use rockfall::layout::Step;
use rockfall::wgpu;
use rockfall::{Cuboid, Result, Scene, Simulation};

pub use crate::bounds::bounds;
use crate::camera::Camera;
use crate::legend::Legend;
pub use crate::palette;

mod coil;
mod cull;
mod formats;
mod frame;
mod glass;
mod layouts;
mod passes;
mod pipelines;
mod pyramid;
mod range;
mod source;
mod style;
mod summary;
mod targets;
mod timing;

use coil::{CoilMesh, Fineness};
use cull::Cull;
use frame::Frame;
use layouts::Layouts;
use pipelines::Pipelines;
use pyramid::MakePyramid;
use range::{FindGreatest, Greatest};
use source::Source;
pub use style::{Background, ColourBy, Range, Style};
use summary::SceneSummary;
use targets::{ShadowMap, Targets};
use timing::Timer;
pub use timing::{FrameTimes, Pass};

/// Draws a simulation onto any texture of one format.
///
/// ```no_run
/// # fn main() -> rockfall::Result<()> {
/// # use rockfall::{wgpu, Scene, Simulation};
/// # use rockfall_viewer::{camera::Camera, draw::{Renderer, Style}};
/// # let (device, queue, mut simulation, target): (wgpu::Device, wgpu::Queue, Simulation, wgpu::TextureView) = todo!();
/// let mut renderer = Renderer::new(&device, &queue, wgpu::TextureFormat::Bgra8Unorm)?;
/// renderer.resize(800, 600);
/// renderer.set_scene(&simulation);
/// let camera = Camera::of_scene(simulation.scene(), 800.0 / 600.0);
/// let style = Style::default();
/// // For every frame:
/// simulation.step(0.02)?;
/// renderer.update(&mut simulation, &style)?;
/// let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
/// renderer.draw(&mut encoder, &target, &camera, &style);
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
    shadows: ShadowMap,
    coil: CoilMesh,
    cull: Cull,
    pyramid: MakePyramid,
    timer: Option<Timer>,
    targets: Option<Targets>,
    summary: Option<SceneSummary>,
    boxes: Vec<Cuboid>,
    /// Whether there are objects of each of the palette's kinds.
    present: [bool; 8],
    find: FindGreatest,
    greatest: Greatest,
    /// What `greatest` is of.
    coloured_by: ColourBy,
    step: Step,
    blend: f32,
}

impl Renderer {
    /// A renderer for textures of this format.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device cannot run the shaders.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Result<Self> {
        catch(device, || Self::make(device, queue, format))
    }

    fn make(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        let pyramid = MakePyramid::new(device);
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
            shadows: ShadowMap::new(device, &layouts),
            coil: CoilMesh::new(device, Fineness::of(0)),
            cull: Cull::new(device, &pyramid.read),
            pyramid,
            timer: None,
            layouts,
            uniform,
            source: Source::default(),
            targets: None,
            summary: None,
            boxes: Vec::new(),
            present: [false; 8],
            find: FindGreatest::new(device, queue),
            greatest: Greatest::default(),
            coloured_by: ColourBy::Kind,
            step: Step::default(),
            blend: 1.0,
        }
    }

    /// Sets the size of what is drawn onto, in pixels; at least 1, at most the device's `max_texture_dimension_2d`.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = [width.max(1), height.max(1)];
        if self.targets.as_ref().is_none_or(|targets| targets.size != size) {
            self.targets = Some(Targets::new(&self.device, &self.layouts, &self.pyramid, size));
        }
    }

    /// Takes in a scene that has not been drawn before: the height of its ground, how large its bodies are, and which
    /// spheres and rods are capsules. What is added to it or removed later, [`Renderer::update`] finds by itself.
    pub fn set_scene(&mut self, simulation: &Simulation) {
        self.summary = Some(SceneSummary::of(simulation.scene()));
        self.take_objects(simulation);
    }

    fn take_objects(&mut self, simulation: &Simulation) {
        self.source.mark_capsules(&self.device, &self.queue, simulation);
        self.boxes = simulation.scene().boxes().to_vec();
        self.present = present(simulation.scene());
    }

    /// Takes in the simulation as it is now. On the GPU backend that is where its buffers are, and nothing is copied; on the
    /// CPU backend the state is uploaded. What [`Style::colour_by`] asks for beyond the state is evaluated on the host.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the GPU failed, or the scene is so large that its state does not fit one binding.
    pub fn update(&mut self, simulation: &mut Simulation, style: &Style) -> Result<()> {
        simulation.flush()?;
        if self.summary.is_none() {
            self.set_scene(simulation);
        } else if self.source.is_stale(simulation) {
            self.take_objects(simulation);
        }
        self.step = self.source.take(&self.device, &self.queue, simulation)?;
        self.take_values(simulation, style)?;
        if self.source.bind(&self.device, &self.layouts.bodies, &self.uniform) {
            self.cull.bind(&self.device, &self.uniform, self.source.bound(), self.step.spheres);
        }
        let fineness = Fineness::of(frame::springs(&self.step) + frame::tethers(&self.step));
        if self.coil.fineness != fineness {
            self.coil = CoilMesh::new(&self.device, fineness);
        }
        Ok(())
    }

    /// Finds what colours are to tell, and how great it is.
    fn take_values(&mut self, simulation: &mut Simulation, style: &Style) -> Result<()> {
        let by = style.colour_by;
        if self.coloured_by != by {
            (self.coloured_by, self.greatest) = (by, Greatest::default());
        }
        if by.is_evaluated() {
            let values: Vec<f32> = simulation.diagnostics()?.iter().map(|found| by.of(found)).collect();
            self.greatest.see(values.iter().copied().fold(0.0, f32::max));
            self.source.set_values(&self.queue, simulation, values.into_iter());
        } else if by == ColourBy::Speed
            && style.range == Range::Auto
            && let Some(state) = self.source.state()
        {
            self.greatest.see(self.find.speed(state, self.step.spheres)?);
        }
        Ok(())
    }

    fn range(&self, style: &Style) -> [f32; 2] {
        match style.range {
            Range::Auto => self.greatest.range(),
            Range::Given(range) => range,
        }
    }

    /// What the colours of the next picture mean.
    pub fn legend(&self, style: &Style) -> Legend {
        match style.colour_by.title() {
            Some(title) => Legend::scale(title, self.range(style)),
            None => {
                let kinds = palette::KINDS.into_iter().zip(self.present);
                Legend::Kinds(kinds.filter(|(_, present)| *present).map(|(kind, _)| kind).collect())
            }
        }
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
        let summary = self.summary.clone().unwrap_or_default();
        self.source.set_opacities(&self.queue, &glass::opacities(&self.boxes, &summary.places, camera.eye));
        let mut frame = Frame::new(&self.step, camera, style, &summary, targets.size);
        (frame.blend, frame.range) = (blend, self.range(style));
        self.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&frame));
        if let Some(timer) = &mut self.timer {
            let covering = frame::is_covering(&self.step);
            timer.begin([true, style.shadows, true, covering, covering, style.occlusion, true]);
        }
        self.choose_spheres(encoder);
        if style.shadows {
            self.draw_shadows(encoder, bodies);
        }
        self.draw_bodies(encoder, targets, bodies, style);
        if style.occlusion {
            self.draw_occlusion(encoder, targets, bodies);
        }
        self.finish(encoder, targets, bodies, target);
        if let Some(timer) = &self.timer {
            timer.end(encoder, self.cull.draws());
        }
    }

    /// Has every frame timed, from now on.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device has no timestamps.
    pub fn time_frames(&mut self) -> Result<()> {
        self.timer = Some(Timer::new(&self.device, &self.queue)?);
        Ok(())
    }

    /// What the last frame that was submitted took on the device, and how much was drawn; waits for it. `None` unless
    /// frames are timed.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device failed.
    pub fn frame_times(&self) -> Result<Option<FrameTimes>> {
        self.timer.as_ref().map(|timer| timer.read(&self.device)).transpose()
    }
}

/// Whether a scene has objects of each of the palette's kinds.
fn present(scene: &Scene) -> [bool; 8] {
    let counts = scene.counts();
    let loose = counts.spheres - 2 * counts.capsules.min(counts.spheres / 2);
    let fixed = scene.spheres().iter().filter(|sphere| sphere.fixed).count();
    let kinds = [
        loose.saturating_sub(fixed),
        fixed,
        counts.rods.saturating_sub(counts.capsules),
        counts.capsules,
        counts.springs,
        counts.tethers,
        counts.boxes,
        counts.polygons,
    ];
    kinds.map(|count| count > 0)
}
