//! Draws a simulation directly from the buffers of the physics.
//!
//! On the GPU backend no body passes through the host: the shaders read the buffers of state, orientations and topology that
//! the kernels wrote. On the CPU backend the same arrays are uploaded, so the same shaders serve both. See [`Renderer`].

use rockfall::exec::gpu::catch;
use rockfall::model::step::Step;
use rockfall::wgpu;
use rockfall::{Result, Simulation};

pub use crate::bounds::bounds;
use crate::camera::Camera;
use crate::extent::Extent;
use crate::legend::Legend;
pub use crate::palette;
use crate::survey::Survey;
use crate::tags::kinds_shown;

mod buffers;
mod chains;
mod coil;
mod cull;
mod formats;
mod frame;
pub(crate) mod joints;
mod layouts;
mod looks;
mod motion;
pub(crate) mod net_force;
mod passes;
mod pipelines;
mod pyramid;
mod range;
mod style;
mod summary;
mod surfaces;
mod targets;
mod timing;
mod values;
mod walls;

use buffers::SceneBuffers;
use chains::Chains;
use coil::{CoilMesh, Resolution};
use cull::Cull;
use frame::Frame;
use joints::Strings;
use layouts::Layouts;
pub use motion::{Arrows, Motion};
use pipelines::Pipelines;
use pyramid::PyramidBuilder;
use range::{RecentPercentile, SpeedPercentile};
pub use style::{Background, ColourBy, Range, Style};
use summary::SceneSummary;
use targets::{ShadowMap, Targets};
use timing::Timer;
pub use timing::{FrameTimes, Pass};
use walls::Walls;

/// Draws a simulation onto textures of one format.
///
/// ```no_run
/// # fn main() -> rockfall::Result<()> {
/// # use rockfall::{wgpu, Scene, Simulation};
/// # use rockfall_viewer::{camera::{Camera, Direction}, draw::{Renderer, Style}};
/// # let (device, queue, mut simulation, target): (wgpu::Device, wgpu::Queue, Simulation, wgpu::TextureView) = todo!();
/// let mut renderer = Renderer::new(&device, &queue, wgpu::TextureFormat::Bgra8Unorm)?;
/// renderer.resize(800, 600);
/// renderer.set_scene(&simulation);
/// let camera = Camera::of_scene(simulation.scene(), 800.0 / 600.0, Direction::Oblique);
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
/// A simulation on the GPU backend must run on the device of the renderer: take the device from `simulation.gpu_view()`, or
/// pass your own to [`Simulation::on_device`]. Open the device with all limits of its adapter, because WebGPU's default
/// limits are too small for large scenes.
#[derive(Debug)]
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layouts: Layouts,
    pipelines: Pipelines,
    uniform: wgpu::Buffer,
    buffers: SceneBuffers,
    shadows: ShadowMap,
    coil: CoilMesh,
    cull: Cull,
    pyramid: PyramidBuilder,
    timer: Option<Timer>,
    targets: Option<Targets>,
    summary: Option<SceneSummary>,
    walls: Walls,
    /// What the bodies do over a film, if that was given.
    survey: Option<Survey>,
    /// Where the bodies are whose values determine the scale.
    region: Extent,
    chains: Chains,
    strings: Strings,
    /// Colours of single spheres, by insertion index.
    colours: Vec<Option<palette::Rgb>>,
    /// Whether colours have to be uploaded.
    colours_due: bool,
    /// [`Scene::tag_changes`] of the colours that were uploaded.
    tag_changes: u64,
    /// [`Scene::tag_changes`] of the looks that were uploaded.
    look_changes: u64,
    /// Whether the scene has objects of each kind of [`palette::KINDS`].
    present: [bool; palette::KINDS.len()],
    speeds: SpeedPercentile,
    recent: RecentPercentile,
    /// The quantity that `recent` belongs to.
    coloured_by: ColourBy,
    step: Step,
    blend: f32,
    motion: Motion,
}

impl Renderer {
    /// Creates a renderer for textures of `format`.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device cannot run the shaders.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Result<Self> {
        catch(device, || Self::make(device, queue, format))
    }

    fn make(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        let pyramid = PyramidBuilder::new(device);
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
            coil: CoilMesh::new(device, Resolution::of(0)),
            cull: Cull::new(device, &pyramid.read),
            pyramid,
            timer: None,
            layouts,
            uniform,
            buffers: SceneBuffers::default(),
            targets: None,
            summary: None,
            walls: Walls::default(),
            survey: None,
            region: Extent::default(),
            chains: Chains::default(),
            strings: Strings::default(),
            colours: Vec::new(),
            colours_due: false,
            tag_changes: 0,
            look_changes: 0,
            present: [false; 8],
            speeds: SpeedPercentile::new(device, queue),
            recent: RecentPercentile::default(),
            coloured_by: ColourBy::Kind,
            step: Step::default(),
            blend: 1.0,
            motion: Motion::default(),
        }
    }

    /// Sets the size of the textures that are drawn onto, in pixels; at least 1, at most the device's
    /// `max_texture_dimension_2d`.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = [width.max(1), height.max(1)];
        if self.targets.as_ref().is_none_or(|targets| targets.size != size) {
            self.targets = Some(Targets::new(&self.device, &self.layouts, &self.pyramid, size));
        }
    }

    /// Prepares the renderer for another scene: the height of its ground, the typical size of its bodies, and which spheres
    /// and rods belong to capsules. Later changes to the objects of the scene are detected by [`Renderer::update`].
    pub fn set_scene(&mut self, simulation: &Simulation) {
        self.motion.forget();
        self.start_from(simulation);
    }

    /// [`Renderer::set_scene`] for a later state of the same scene, which keeps its trails and plots.
    pub fn start_from(&mut self, simulation: &Simulation) {
        self.summary = Some(SceneSummary::of(simulation.scene()));
        self.survey = None;
        self.recent = RecentPercentile::default();
        self.update_objects(simulation);
        self.set_region(&Survey::new(simulation.scene()));
    }

    /// Moves the ground down if a body has fallen below it since [`Renderer::set_scene`], in the state that was read back last.
    pub fn keep_ground_below(&mut self, simulation: &Simulation) {
        if let Some(summary) = &mut self.summary {
            summary.keep_below(simulation.scene());
        }
    }

    fn update_objects(&mut self, simulation: &Simulation) {
        self.buffers.allocate(&self.device, &self.queue, simulation);
        self.walls.set_scene(simulation.scene());
        self.update_looks(simulation);
        self.colours_due = true;
    }

    fn update_looks(&mut self, simulation: &Simulation) {
        self.look_changes = simulation.scene().tag_changes();
        self.present = kinds_shown(simulation.scene());
        self.buffers.mark(&self.device, &self.queue, simulation.scene());
        self.walls.set_glass(simulation.scene());
    }

    /// Updates what is drawn to the present state of the simulation. On the GPU backend only references to its buffers are
    /// taken and nothing is copied. On the CPU backend the state is uploaded. A quantity of [`Style::colour_by`] that is not
    /// part of the state is evaluated on the host.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the GPU failed, or when the scene is so large that its state does not fit one binding.
    pub fn update(&mut self, simulation: &mut Simulation, style: &Style) -> Result<()> {
        simulation.flush()?;
        if self.summary.is_none() {
            self.set_scene(simulation);
        } else if self.buffers.is_stale(simulation) {
            self.update_objects(simulation);
        } else if self.look_changes != simulation.scene().tag_changes() {
            self.update_looks(simulation);
        }
        match &self.survey {
            Some(survey) => self.walls.set_bodies(survey),
            None if self.walls.is_empty() => (),
            None => self.walls.set_bodies(&Survey::new(simulation.scene())),
        }
        if simulation.gpu_view().is_none() && simulation.cpu_view().is_none() {
            simulation.sync()?;
        }
        self.step = self.buffers.update(&self.device, &self.queue, simulation)?;
        self.update_values(simulation, style)?;
        self.motion.update(simulation)?;
        if self.buffers.bind(&self.device, &self.layouts.bodies, &self.uniform) {
            self.cull.bind(&self.device, &self.uniform, self.buffers.bound_buffers(), self.step.layout.spheres);
        }
        let resolution = Resolution::of(frame::springs(&self.step) + frame::tethers(&self.step));
        if self.coil.resolution != resolution {
            self.coil = CoilMesh::new(&self.device, resolution);
        }
        Ok(())
    }

    /// Returns the legend of the next picture.
    pub fn legend(&self, style: &Style) -> Legend {
        match style.colour_by.title() {
            Some(title) => Legend::Scale { title, range: self.range(style), colours: style.colour_by.scale() },
            None => {
                let shown = self.present.map(|present| present && style.colour_by == ColourBy::Kind);
                let kinds = palette::KINDS.into_iter().zip(style.kinds).zip(shown);
                Legend::Kinds(
                    kinds.filter(|(_, shown)| *shown).map(|((kind, colour), _)| palette::Kind { colour, ..kind }).collect(),
                )
            }
        }
    }

    /// Copies the positions and orientations of the last [`Renderer::update`], on the device, as the state to blend from.
    pub fn remember(&mut self) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.buffers.remember(&mut encoder, self.step.layout.spheres);
        self.queue.submit([encoder.finish()]);
        self.motion.remember();
    }

    /// Sets the blend factor of the next [`Renderer::draw`]: 0 shows the bodies where they were at the last
    /// [`Renderer::remember`], 1 where they are now. If the order of the spheres in memory has changed in between, they are
    /// shown where they are now.
    pub fn set_blend(&mut self, blend: f32) {
        self.blend = blend.clamp(0.0, 1.0);
        self.motion.set_blend(self.blend);
    }

    /// Draws the state of the last [`Renderer::update`] onto the whole of `target`, whose size must be that of
    /// [`Renderer::resize`].
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, camera: &Camera, style: &Style) {
        let (Some(targets), Some(bodies)) = (&self.targets, &self.buffers.group) else {
            return;
        };
        let blend = if self.buffers.can_blend() { self.blend } else { 1.0 };
        self.strings.set(&self.device, &self.queue, &self.motion.strings());
        let summary = self.summary.clone().unwrap_or_default();
        self.buffers.set_drawn(&self.queue, &self.walls.drawn(camera.eye, camera.up, self.survey.is_none()));
        let mut frame = Frame::new(&self.step, camera, style, &summary, targets.size);
        (frame.blend, frame.range) = (blend, self.range(style));
        frame.set_looks(self.buffers.has_looks);
        self.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&frame));
        if let Some(timer) = &mut self.timer {
            let culls_hidden = frame::culls_hidden(&self.step);
            timer.begin([true, style.shadows, true, culls_hidden, culls_hidden, style.occlusion, true]);
        }
        self.cull_spheres(encoder);
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

    /// Measures the time of every frame from now on.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device has no timestamps.
    pub fn time_frames(&mut self) -> Result<()> {
        self.timer = Some(Timer::new(&self.device, &self.queue)?);
        Ok(())
    }

    /// Waits for the last submitted frame, and returns its times on the device and the number of spheres drawn; `None` unless
    /// frames are timed.
    ///
    /// # Errors
    /// [`rockfall::Error::Device`] when the device failed.
    pub fn frame_times(&self) -> Result<Option<FrameTimes>> {
        self.timer.as_ref().map(|timer| timer.read(&self.device)).transpose()
    }
}
