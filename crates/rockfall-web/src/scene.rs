//! Scenes.

use std::path::Path;

use rockfall::generate::Benchmark;
use rockfall_viewer::camera::{Camera, Direction};
use wasm_bindgen::prelude::*;

use crate::errors::thrown;

/// A scene: objects and physical constants.
#[wasm_bindgen]
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) inner: rockfall::Scene,
    warnings: Vec<String>,
}

#[wasm_bindgen]
impl Scene {
    /// Reads a scene text. `name` names it in messages; the default is `scene`.
    ///
    /// Throws a `SceneError` for the first wrong line, with the properties `line` (from 1) and `field`.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str, name: Option<String>) -> Result<Scene, JsValue> {
        let name = name.unwrap_or_else(|| "scene".to_owned());
        let loaded = rockfall::Scene::parse(text, Path::new(&name)).map_err(thrown)?;
        let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
        Ok(Self { inner: loaded.scene, warnings })
    }

    /// Generates a scene of `bodies` bodies: `thesis`, `lattice`, `pile`, `settled`, `shuffled`, `mixed` or `radii`.
    ///
    /// Throws for an unknown kind and for more bodies than the engine supports.
    pub fn generate(kind: &str, bodies: u32, seed: u32) -> Result<Scene, JsValue> {
        let kind: Benchmark = kind.parse().map_err(thrown)?;
        let inner = kind.generate(bodies, seed.into()).map_err(thrown)?;
        Ok(Self { inner, warnings: Vec::new() })
    }

    /// Time step of a step of a simulation, in s, that the line `@run` of the scene gives; `undefined` without one.
    #[wasm_bindgen(getter, js_name = timeStep)]
    pub fn time_step(&self) -> Option<f32> {
        self.inner.time_step()
    }

    /// Warnings about lines that were accepted, each with its line number.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Number of spheres, with the ends of capsules.
    #[wasm_bindgen(getter)]
    pub fn spheres(&self) -> usize {
        self.inner.counts().spheres
    }

    /// Number of all objects.
    #[wasm_bindgen(getter)]
    pub fn objects(&self) -> usize {
        let counts = self.inner.counts();
        counts.spheres + counts.rods + counts.boxes + counts.polygons
    }

    /// A camera that shows the bodies of the scene in a picture with this aspect ratio (width divided by height): x, y, z of
    /// the eye, then of the point that it looks at, in units, and of the unit vector upwards, which is opposite to gravity if
    /// that is along an axis, else +y. Its vertical field of view is 0.6 rad.
    pub fn camera(&self, aspect: f32) -> Vec<f32> {
        let camera = Camera::of_scene(&self.inner, aspect, Direction::Oblique);
        [camera.eye, camera.target, camera.up.vector()].into_iter().flat_map(|point| point.to_array()).collect()
    }

    /// The scene as a scene text.
    #[wasm_bindgen(js_name = toText)]
    pub fn to_text(&self) -> String {
        self.inner.to_text()
    }
}
