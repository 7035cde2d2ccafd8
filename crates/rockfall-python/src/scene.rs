//! The native scene.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use rockfall::{Body, IntegratorChoice, RunDefaults};

use crate::errors::{Raise, in_python, raise_import};
use crate::fork::detached;
use crate::ids::Ids;

/// Number of bodies that fall for ever that are named.
const SHOWN: usize = 10;

/// Time step in s, integrator, steps, every, substeps, speed of films.
type RunValues = (Option<f32>, Option<String>, Option<u64>, Option<u64>, Option<u32>, Option<f64>);

/// A scene and the numbers of its objects.
#[derive(Debug)]
pub(crate) struct Built {
    pub(crate) scene: rockfall::Scene,
    pub(crate) ids: Ids,
    /// Warnings about the text that it was read from: line number and text.
    warnings: Vec<(usize, String)>,
}

/// Objects and physical constants.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct Scene(pub(crate) Mutex<Built>);

impl Scene {
    pub(crate) fn of(scene: rockfall::Scene) -> Self {
        let ids = Ids::of(&scene);
        Self(Mutex::new(Built { scene, ids, warnings: Vec::new() }))
    }

    fn read(loaded: rockfall::Loaded) -> Self {
        let built = Self::of(loaded.scene);
        built.lock().warnings = loaded.warnings.into_iter().map(|warning| (warning.line, warning.text)).collect();
        built
    }

    /// Only for work that does not wait for Python.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Built> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Self {
        Self::of(rockfall::Scene::new())
    }

    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        detached(py, || rockfall::Scene::parse(text, Path::new(name)).or_raise().map(Self::read))
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        detached(py, || rockfall::Scene::load(path).or_raise().map(Self::read))
    }

    /// Reads a URDF or MJCF file. Returns the scene and the notes on what it does not have.
    #[staticmethod]
    fn load_robot(py: Python<'_>, path: PathBuf, format: &str) -> PyResult<(Self, Vec<String>)> {
        let load = if format == "urdf" { rockfall_import::load_urdf } else { rockfall_import::load_mjcf };
        detached(py, || {
            let imported = load(path).map_err(raise_import)?;
            Ok((Self::of(imported.scene), imported.notes))
        })
    }

    fn to_text(&self, py: Python<'_>) -> String {
        detached(py, || self.lock().scene.to_text())
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        detached(py, || self.lock().scene.save(path).or_raise())
    }

    fn copy(&self, py: Python<'_>) -> Self {
        detached(py, || {
            let built = self.lock();
            Self(Mutex::new(Built { scene: built.scene.clone(), ids: built.ids.clone(), warnings: built.warnings.clone() }))
        })
    }

    /// How the scene is meant to be run: time step, integrator, steps, every, substeps, speed of films.
    fn run_defaults(&self) -> RunValues {
        let run = self.lock().scene.run;
        (run.dt, run.integrator.map(|integrator| integrator.to_string()), run.steps, run.every, run.substeps, run.speed)
    }

    fn set_run_defaults(&self, run: RunValues) -> PyResult<()> {
        let (dt, integrator, steps, every, substeps, speed) = run;
        let mut run = RunDefaults::default();
        run.integrator = integrator.map(|name| name.parse()).transpose().or_raise()?;
        (run.dt, run.steps, run.every, run.substeps, run.speed) = (dt, steps, every, substeps, speed);
        run.validate().or_raise()?;
        self.lock().scene.run = run;
        Ok(())
    }

    /// The time step of a simulation, in s.
    fn time_step(&self) -> Option<f32> {
        self.lock().scene.time_step()
    }

    fn warnings(&self, py: Python<'_>) -> Vec<(usize, String)> {
        detached(py, || self.lock().warnings.clone())
    }

    /// Warnings about an unsuitable time step or contact force, and about bodies that overlap.
    fn check(&self, py: Python<'_>, dt: f32, integrator: &str) -> PyResult<Vec<String>> {
        let integrator: IntegratorChoice = integrator.parse().or_raise()?;
        detached(py, || {
            let scene = &self.lock().scene;
            let integrator = scene.integrator(integrator);
            let concerns = scene.with_grains().concerns(dt, integrator).into_iter().chain(scene.inlet_concerns());
            let mut found: Vec<String> = concerns.map(|concern| in_python(&concern)).collect();
            let placement = scene.placement().or_raise()?;
            found.extend(placement.overlaps.iter().map(|overlap| format!("{} at the start", overlap.describe(scene))));
            let falls = "will fall for ever: nothing holds it, and nothing is below it along gravity";
            let falling = placement.falling.iter().take(SHOWN).map(|sphere| scene.name_of(Body::Sphere(*sphere)));
            found.extend(falling.map(|body| format!("{body} {falls}")));
            if placement.falling.len() > SHOWN {
                found.push(format!("{} more bodies will fall for ever", placement.falling.len() - SHOWN));
            }
            Ok(found)
        })
    }
}
