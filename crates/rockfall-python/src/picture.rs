//! Pictures of simulations.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rockfall::exec::gpu::Gpu;
use rockfall::glam::Vec3;
use rockfall::{Body, Scene, SphereId};
use rockfall_viewer::camera::{Camera, Direction, Up, Vertical};
use rockfall_viewer::draw::{ColourBy, Range, Renderer, Style};
use rockfall_viewer::legend::Corner;
use rockfall_viewer::overlay::{self, Arrows, Overlay, body_number};
use rockfall_viewer::picture::{Canvas, FORMAT};
use rockfall_viewer::plot::{Graph, Layout, Plot, bodies_named, named};
use rockfall_viewer::survey::Survey;

use crate::errors::{Raise, SimulationError};
use crate::fork::{Owned, check_graphics, detached, graphics_opened};
use crate::ids::{Ids, handle};
use crate::simulation::Simulation;

/// A picture in host memory.
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct Picture(pub(crate) rockfall_viewer::picture::Picture);

#[pymethods]
impl Picture {
    /// Width and height, in pixels.
    fn size(&self) -> (u32, u32) {
        (self.0.width, self.0.height)
    }

    /// Red, green and blue of every pixel, of shape (height, width, 3).
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let shape = [self.0.height as usize, self.0.width as usize, 3];
        Ok(PyArray1::from_vec(py, self.0.rgb()).reshape(shape)?.into_any())
    }

    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = detached(py, || {
            let mut bytes = Vec::new();
            self.0.write_png(&mut bytes).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn jpeg<'py>(&self, py: Python<'py>, quality: u8) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = detached(py, || {
            let mut bytes = Vec::new();
            self.0.write_jpeg(&mut bytes, quality).map(|()| bytes)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }
}

/// What a picture shows. Python passes it as a dict.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Look {
    /// Width and height, in pixels.
    pub(crate) size: (u32, u32),
    pub(crate) colour_by: Option<String>,
    pub(crate) range: Option<[f32; 2]>,
    pub(crate) camera: Option<[f32; 3]>,
    pub(crate) look_at: Option<[f32; 3]>,
    pub(crate) view: Option<String>,
    up: String,
    pub(crate) plain: bool,
    title: Option<String>,
    clock: bool,
    scale_bar: bool,
    label: bool,
    arrows: Option<String>,
    trails: f64,
    trails_of: Vec<String>,
    plot: Vec<String>,
}

impl Look {
    /// The style, without a colour scale that depends on the state.
    pub(crate) fn style(&self) -> PyResult<Style> {
        let mut style = Style::default();
        if let Some(name) = &self.colour_by {
            style.colour_by = ColourBy::ALL.into_iter().find(|by| by.name() == name).ok_or_else(|| {
                let names = ColourBy::ALL.map(ColourBy::name).join(", ");
                PyValueError::new_err(format!("colour_by: {name:?} is not known, expected one of: {names}"))
            })?;
        }
        style.range = self.range.map_or(Range::Auto, Range::Given);
        (style.shadows, style.occlusion) = (!self.plain, !self.plain);
        Ok(style)
    }

    /// The direction from which the camera looks, unless its position is given.
    pub(crate) fn direction(&self) -> PyResult<Direction> {
        let Some(name) = &self.view else { return Ok(Direction::default()) };
        Direction::named(name).map_err(|expected| PyValueError::new_err(format!("view: {name:?} is not known, {expected}")))
    }

    /// The axis to the top of pictures of a scene.
    pub(crate) fn up(&self, scene: &Scene) -> PyResult<Up> {
        let wrong = |expected| PyValueError::new_err(format!("up: {:?} is not known, {expected}", self.up));
        Vertical::named(&self.up).map_err(wrong).map(|vertical| vertical.of(scene))
    }

    /// The text, arrows and trails over the picture.
    pub(crate) fn overlay(&self) -> PyResult<Overlay> {
        let arrows = self.arrows.as_deref().map(|name| {
            Arrows::named(name).map_err(|expected| PyValueError::new_err(format!("arrows: {name:?} is not known, {expected}")))
        });
        Ok(Overlay {
            title: self.title.clone(),
            clock: self.clock,
            scale_bar: self.scale_bar,
            labels: self.label,
            arrows: arrows.transpose()?,
            arrow_key: None,
            trails: self.trails,
            trails_of: self.trails_of.clone(),
            joints: false,
            dark: self.style()?.background.is_dark(),
        })
    }

    /// Where the scene and the plots are in the pictures.
    pub(crate) fn layout(&self) -> Layout {
        let dark = self.style().is_ok_and(|style| style.background.is_dark());
        Layout::new(self.size.into(), self.plot.len()).dark(dark)
    }

    /// The sphere that a name or a number of trails means.
    fn find(name: &str, scene: &Scene, ids: &Ids) -> PyResult<SphereId> {
        match name.parse() {
            Ok(number) => handle(&ids.spheres, "sphere", number),
            Err(_) => named(scene, name).map_err(|error| PyKeyError::new_err(format!("trails: {error}"))),
        }
    }

    /// Finds the bodies that have trails in a scene, and replaces the numbers of spheres by those that the overlay knows.
    pub(crate) fn find_trails(&mut self, scene: &Scene, ids: &Ids) -> PyResult<()> {
        for name in &mut self.trails_of {
            let sphere = Self::find(name, scene, ids)?;
            if name.parse::<i64>().is_ok() {
                *name = body_number(scene, sphere);
            }
        }
        Ok(())
    }

    /// The plots of a scene.
    pub(crate) fn graphs(&self, scene: &Scene, ids: &Ids) -> PyResult<Vec<Graph>> {
        Layout::check(self.size.into(), self.plot.len()).map_err(|error| PyValueError::new_err(format!("plot: {error}")))?;
        let find = |name: &String| match name.parse() {
            Ok(number) => handle(&ids.spheres, "sphere", number).map(|sphere| vec![Body::Sphere(sphere)]),
            Err(_) => bodies_named(scene, name).map_err(|error| PyKeyError::new_err(format!("plot: {error}"))),
        };
        let plot = |text: &String| Plot::parse(text).map_err(|error| PyValueError::new_err(format!("plot: {error}")));
        let graph = |text: &String| {
            let plot = plot(text)?;
            plot.check_names(scene).map_err(|error| PyKeyError::new_err(format!("plot: {error}")))?;
            let found: Vec<_> = plot.bodies().iter().map(find).collect::<PyResult<_>>()?;
            plot.of(scene, &found).map_err(|error| PyValueError::new_err(format!("plot: {error}")))
        };
        self.plot.iter().map(graph).collect()
    }

    /// The camera for the state of a simulation.
    fn framing(&self, simulation: &mut rockfall::Simulation) -> PyResult<Camera> {
        let [width, height] = self.layout().scene();
        let scene = simulation.sync().or_raise()?;
        let survey = Survey::with_up(scene, self.up(scene)?);
        let framing = Camera::of_survey(&survey, simulation.scene(), width as f32 / height as f32, self.direction()?, false);
        let eye = self.camera.map_or(framing.eye, Into::into);
        let target = self.look_at.map_or(framing.target, Into::into);
        if eye == target {
            return Err(PyValueError::new_err("camera and look_at are the same point, expected two different points"));
        }
        Ok(Camera { eye, target, ..framing })
    }
}

/// What is needed to draw on a device.
pub(crate) struct Tools {
    gpu: Gpu,
    pub(crate) renderer: Renderer,
    canvas: Canvas,
    size: (u32, u32),
    /// The plots that the renderer has.
    plot: Vec<String>,
}

impl Tools {
    /// The device is that of the simulation, or for one on the CPU any adapter, including software.
    pub(crate) fn new(simulation: &rockfall::Simulation, size: (u32, u32)) -> PyResult<Self> {
        check_graphics()?;
        graphics_opened();
        let gpu = match simulation.gpu_view() {
            Some(view) => view.gpu().clone(),
            None => Gpu::open_blocking(true).map_err(|error| {
                let text =
                    format!("drawing needs a graphics adapter, even with backend=\"cpu\"; software Vulkan is enough: {error}");
                SimulationError::new_err(text)
            })?,
        };
        let canvas = Canvas::new(gpu.device(), gpu.queue(), size.0, size.1).or_raise()?;
        let renderer = Renderer::new(gpu.device(), gpu.queue(), FORMAT).or_raise()?;
        Ok(Self { gpu, renderer, canvas, size, plot: Vec::new() })
    }

    fn resize(&mut self, size: (u32, u32)) -> PyResult<()> {
        if self.size != size {
            self.canvas = Canvas::new(self.gpu.device(), self.gpu.queue(), size.0, size.1).or_raise()?;
            self.size = size;
        }
        Ok(())
    }

    /// Gives the renderer the plots of a picture. It keeps what they have seen of the same simulation, unless they are others.
    fn set_plots(&mut self, look: &Look, scene: &Scene, ids: &Ids, is_other: bool) -> PyResult<()> {
        if is_other || self.plot != look.plot {
            self.renderer.set_plots(look.graphs(scene, ids)?);
            self.plot.clone_from(&look.plot);
        }
        Ok(())
    }

    /// Draws what the renderer has.
    pub(crate) fn take(
        &mut self,
        camera: &Camera,
        style: &Style,
        overlay: &Overlay,
        legend: Option<Corner>,
    ) -> PyResult<rockfall_viewer::picture::Picture> {
        let mut picture = self.canvas.take(&mut self.renderer, camera, style).or_raise()?;
        if let Some(corner) = legend {
            self.renderer.legend(style).draw_at(corner, &mut picture).or_raise()?;
        }
        self.renderer.record();
        overlay.draw(self.renderer.motion(), camera, &mut picture).or_raise()?;
        Ok(picture)
    }
}

/// Draws pictures. Kept between pictures, because creating the tools takes longer than drawing.
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct Studio(std::sync::Mutex<Option<Owned<Tools>>>);

#[pymethods]
impl Studio {
    #[new]
    fn new() -> Self {
        Self(std::sync::Mutex::new(None))
    }

    /// Draws the state of a simulation, which may be another one than the last time.
    fn take(&self, simulation: &Bound<'_, Simulation>, mut look: Look, is_other: bool) -> PyResult<Picture> {
        let (style, layout) = (look.style()?, look.layout());
        let size = layout.scene().into();
        simulation.get().read(simulation.py(), |running| {
            look.find_trails(running.simulation.scene(), &running.ids)?;
            let overlay = look.overlay()?;
            let mut tools = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let own = &mut running.simulation;
            if tools.is_none() {
                *tools = Some(Owned::new(Tools::new(own, size)?));
            }
            let Some(tools) = tools.as_mut() else {
                return Err(SimulationError::new_err("nothing to draw with"));
            };
            tools.check(true)?;
            tools.resize(size)?;
            let camera = look.framing(own)?;
            tools.renderer.set_overlay(&overlay);
            tools.set_plots(&look, own.scene(), &running.ids, is_other)?;
            if is_other {
                tools.renderer.set_scene(own);
            }
            tools.renderer.update(own, &style).or_raise()?;
            let legend = look.colour_by.as_ref().map(|_| tools.renderer.legend(&style));
            let survey = || Survey::with_up(own.scene(), camera.up);
            let corner = legend.map(|legend| overlay.corner(&legend, &survey(), &camera, layout.scene()));
            let picture = tools.take(&camera, &style, &overlay, corner)?;
            layout.complete(picture, tools.renderer.motion().plots()).or_raise().map(Picture)
        })
    }
}

/// The position and the target of the camera that [`Studio::take`] uses, and the vectors upwards and to the front.
#[pyfunction]
pub(crate) fn framing(simulation: &Bound<'_, Simulation>, look: Look) -> PyResult<[[f32; 3]; 4]> {
    simulation.get().read(simulation.py(), |running| {
        let camera = look.framing(&mut running.simulation)?;
        Ok([camera.eye, camera.target, camera.up.vector(), camera.up.to_scene(Vec3::Z)].map(|vector| vector.to_array()))
    })
}

/// The length of trails in s and the names or numbers of the bodies that have them, of a text such as `2:left`.
#[pyfunction]
pub(crate) fn trails_of(text: &str) -> PyResult<(f64, Vec<String>)> {
    overlay::trails_of(text).map_err(|expected| PyValueError::new_err(format!("trails: {text:?}: {expected}")))
}

/// The warning of the letters that the font lacks, of the title and the labels of a picture.
#[pyfunction]
pub(crate) fn warning_of_letters(simulation: &Bound<'_, Simulation>, look: Look) -> PyResult<Option<String>> {
    let overlay = look.overlay()?;
    simulation.get().read(simulation.py(), |running| Ok(overlay.warning_of_letters(running.simulation.scene())))
}
