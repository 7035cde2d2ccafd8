//! Text, arrows, trails and plots over the picture. The page draws them in a 2D context.

use js_sys::Function;
use rockfall::glam::Vec3;
use rockfall::{Body, SphereId};
use rockfall_viewer::camera::{Camera, Up};
use rockfall_viewer::draw::Motion;
use rockfall_viewer::overlay::{self, Arrows, Mark};
use rockfall_viewer::plot::{Graph, Layout, Plot, bodies_named};
use wasm_bindgen::prelude::*;

use crate::errors::thrown;
use crate::simulation::Simulation;

/// What is written and drawn over the picture of one simulation.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Overlay {
    inner: overlay::Overlay,
    motion: Motion,
    camera: Camera,
    plots: usize,
}

/// Marks on a picture, in pixels from its upper left corner. They are drawn in the order of the fields.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// Filled rectangles: left, upper, right and lower side, then red, green and blue from 0 to 255; 7 numbers each.
    pub rectangles: Vec<f32>,
    /// Lines: x and y of both ends, width, red, green and blue, opacity; 9 numbers each.
    pub lines: Vec<f32>,
    /// Filled triangles: x and y of the corners, red, green and blue; 9 numbers each.
    pub triangles: Vec<f32>,
    /// Lines of text.
    pub texts: Vec<String>,
    /// For every text the place that it is aligned to, which part of its width is to the left of the place and which part of its height above
    /// it, the height of the letters, red, green and blue, and 1 for a light background or 0; 9 numbers each.
    pub places: Vec<f32>,
}

#[wasm_bindgen]
impl Overlay {
    /// An overlay that shows nothing.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Overlay {
        let camera = Camera::new([0.0, 0.0, 1.0], [0.0; 3]);
        Self { inner: overlay::Overlay::default(), motion: Motion::default(), camera, plots: 0 }
    }

    /// Sets the line of text at the upper edge; an empty one is none.
    #[wasm_bindgen(js_name = setTitle)]
    pub fn set_title(&mut self, title: &str) {
        self.inner.title = Some(title.trim().to_owned()).filter(|title| !title.is_empty());
    }

    /// Sets whether the time of the simulation is shown, whether a bar shows a length, and whether spheres have their labels or
    /// numbers.
    #[wasm_bindgen(js_name = setTexts)]
    pub fn set_texts(&mut self, clock: bool, scale_bar: bool, labels: bool) {
        (self.inner.clock, self.inner.scale_bar, self.inner.labels) = (clock, scale_bar, labels);
    }

    /// Sets what the arrows of the spheres show: `velocity`, `force`, `gravity`, or nothing for an empty text.
    ///
    /// Throws for another text.
    #[wasm_bindgen(js_name = setArrows)]
    pub fn set_arrows(&mut self, what: &str) -> Result<(), JsValue> {
        let named = Some(what).filter(|what| !what.is_empty()).map(Arrows::named);
        self.inner.arrows = named.transpose().map_err(|wrong| js_sys::Error::new(&format!("arrows: {what}: {wrong}")))?;
        Ok(())
    }

    /// Sets the length of the trails in s; 0 for none.
    #[wasm_bindgen(js_name = setTrails)]
    pub fn set_trails(&mut self, seconds: f64) {
        self.inner.trails = if seconds.is_finite() { seconds.max(0.0) } else { 0.0 };
    }

    /// Sets whether lines are light, for a dark background.
    #[wasm_bindgen(js_name = setDark)]
    pub fn set_dark(&mut self, dark: bool) {
        self.inner.dark = dark;
    }

    /// Sets the plots, for example `energy` or `height:left,3`: quantities of the scene, or of spheres by their names or numbers. A
    /// number is a reference in the scene text, or in a scene without references the order of addition.
    ///
    /// Throws when a quantity or a body is unknown; the plots stay as they are then.
    #[wasm_bindgen(js_name = setPlots)]
    pub fn set_plots(&mut self, plots: Vec<String>, simulation: &Simulation) -> Result<(), JsValue> {
        let graphs: Result<Vec<Graph>, String> = plots.iter().map(|text| graph(text, simulation)).collect();
        let graphs = graphs.map_err(|wrong| js_sys::Error::new(&wrong))?;
        self.plots = graphs.len();
        self.motion.set_plots(graphs);
        Ok(())
    }

    /// Whether anything is shown.
    #[wasm_bindgen(getter, js_name = isEmpty)]
    pub fn is_empty(&self) -> bool {
        self.plots == 0 && self.inner == overlay::Overlay { dark: self.inner.dark, ..overlay::Overlay::default() }
    }

    /// Whether it needs the present state of the spheres, which takes longer in large scenes.
    #[wasm_bindgen(getter, js_name = needsState)]
    pub fn needs_state(&self) -> bool {
        self.plots > 0 || self.inner.needs_places()
    }

    /// Width and height that the picture of the scene has beside the plots, in a picture of this size.
    #[wasm_bindgen(js_name = sceneSize)]
    pub fn scene_size(&self, width: u32, height: u32) -> Vec<u32> {
        self.layout(width, height).scene().to_vec()
    }

    /// Takes the present state of the simulation.
    ///
    /// Rejects when a quantity needs what a browser cannot read from the GPU, such as the forces of laws that keep springs.
    pub async fn update(&mut self, simulation: &mut Simulation) -> Result<(), JsValue> {
        if self.needs_state() {
            simulation.inner.sync_async().await.map_err(thrown)?;
        }
        self.camera.up = Up::of(simulation.inner.scene());
        self.inner.observe(&mut self.motion, &mut simulation.inner).map_err(thrown)
    }

    /// Sets the camera: x, y, z of the eye and of the point that it looks at, in units.
    #[wasm_bindgen(js_name = setCamera)]
    pub fn set_camera(&mut self, ex: f32, ey: f32, ez: f32, tx: f32, ty: f32, tz: f32) {
        (self.camera.eye, self.camera.target) = (Vec3::new(ex, ey, ez), Vec3::new(tx, ty, tz));
    }

    /// Returns the marks on the picture of the scene, beside which the plots are.
    pub fn marks(&self, width: u32, height: u32) -> Marks {
        let scene = self.layout(width, height).scene();
        Marks::of(&self.inner.marks_of(&self.motion, &self.camera, scene))
    }

    /// Returns the marks of the plots on the whole picture. `measure` returns the width of a text with letters of a height, in pixels.
    #[wasm_bindgen(js_name = plotMarks)]
    pub fn plot_marks(&self, width: u32, height: u32, measure: &Function) -> Marks {
        let width_of = |text: &str, em: f32| {
            let width = measure.call2(&JsValue::NULL, &text.into(), &em.into());
            width.ok().and_then(|width| width.as_f64()).unwrap_or(0.0) as f32
        };
        Marks::of(&self.layout(width, height).marks(self.motion.plots(), &width_of))
    }
}

impl Overlay {
    fn layout(&self, width: u32, height: u32) -> Layout {
        Layout::new([width, height], self.plots).dark(self.inner.dark)
    }
}

impl Marks {
    fn of(all: &[Mark]) -> Self {
        let mut marks = Self::default();
        all.iter().for_each(|mark| marks.add(mark));
        marks
    }

    fn add(&mut self, mark: &Mark) {
        let parts = |colour: &[u8; 3]| colour.map(f32::from);
        match mark {
            Mark::Rectangle { sides, colour } => self.rectangles.extend(sides.iter().copied().chain(parts(colour))),
            Mark::Line { ends, width, colour, opacity } => {
                self.lines.extend(ends.as_flattened());
                self.lines.push(*width);
                self.lines.extend(parts(colour));
                self.lines.push(*opacity);
            }
            Mark::Triangle { corners, colour } => {
                self.triangles.extend(corners.as_flattened().iter().copied().chain(parts(colour)));
            }
            Mark::Text { text, at, align, em, colour, panel } => {
                self.texts.push(text.clone());
                self.places
                    .extend(at.iter().chain(align).copied().chain([*em]).chain(parts(colour)).chain([f32::from(*panel)]));
            }
        }
    }
}

/// The plot that a text means.
fn graph(text: &str, simulation: &Simulation) -> Result<Graph, String> {
    let scene = simulation.inner.scene();
    let plot = Plot::parse(text)?;
    plot.check_names(scene)?;
    let has_references = scene.sphere_ids().any(|sphere| scene.reference(sphere).is_some());
    let numbered = |number: u32| -> Option<SphereId> {
        match has_references {
            true => scene.sphere_ids().find(|sphere| scene.reference(*sphere) == Some(number)),
            false => scene.sphere_ids().nth(number as usize),
        }
    };
    let found = |name: &String| match name.parse::<u32>() {
        Ok(number) => {
            numbered(number).map(|sphere| vec![Body::Sphere(sphere)]).ok_or_else(|| format!("there is no sphere {number}"))
        }
        Err(_) => bodies_named(scene, name),
    };
    let found: Result<Vec<_>, String> = plot.bodies().iter().map(found).collect();
    found.and_then(|found| plot.of(scene, &found)).map_err(|wrong| format!("{text}: {wrong}"))
}
