//! Simulations.

use rockfall::glam::Vec3;
use rockfall::{Backend, Grip, Options, SphereId, TetherId};
use wasm_bindgen::prelude::*;

use crate::errors::thrown;
use crate::scene::Scene;

/// Advances a scene in time, on WebGPU or on the CPU. Only one call may be under way at a time: await each.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Simulation {
    pub(crate) inner: rockfall::Simulation,
    pub(crate) held: Option<Held>,
}

/// Number of steps after which the tether of a held sphere follows it.
const HELD_STEPS: u32 = 10;

/// A body that is held.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Held {
    /// By a tether to a sphere.
    Tether(Tied),
    /// By the point that was picked, under the contact law `rigid`.
    Grip(Grip),
}

/// A sphere that a tether holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tied {
    pub(crate) sphere: SphereId,
    pub(crate) tether: TetherId,
    /// Number of moving spheres that rods and springs connect to it, with itself.
    pub(crate) connected: usize,
    /// Where its centre is dragged to.
    pub(crate) goal: Vec3,
    /// Vector from the grabbed point to the centre of the sphere.
    pub(crate) offset: Vec3,
}

/// Counts and times of all steps so far.
#[wasm_bindgen]
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Number of steps done.
    pub steps: f64,
    /// Time simulated, in s.
    pub time: f64,
    /// Number of contacts (overlapping pairs) in the last step.
    pub contacts: u32,
    /// Number of collisions handled in the last step.
    pub collisions: u32,
    /// Deepest overlap in the last step, in units.
    #[wasm_bindgen(js_name = maxOverlap)]
    pub max_overlap: f32,
    /// Number of steps that were repeated because a list had to grow or a body left its bounding box.
    pub replays: f64,
}

impl From<rockfall::Report> for Report {
    fn from(report: rockfall::Report) -> Self {
        Self {
            steps: report.steps as f64,
            time: report.time,
            contacts: report.contacts,
            collisions: report.collisions,
            max_overlap: report.max_overlap,
            replays: report.replays as f64,
        }
    }
}

/// Energies of the current state, in mass units²/s².
#[wasm_bindgen]
#[derive(Clone, Copy, Debug)]
pub struct Energy {
    /// Kinetic energy, including rotation.
    pub kinetic: f64,
    /// Potential energy in gravity.
    pub potential: f64,
    /// Elastic energy of springs and tethers.
    pub spring: f64,
    /// Elastic energy of contacts.
    pub contact: f64,
}

#[wasm_bindgen]
impl Simulation {
    /// Opens a simulation of a copy of the scene. `backend` is `auto`, `gpu` or `cpu`. `auto` (the default) uses the
    /// CPU for up to 128 spheres and rods, otherwise a hardware GPU if the browser offers one.
    ///
    /// Rejects with a `NoAdapterError` for `gpu` without WebGPU, and with a `DeviceLimitError` when the scene exceeds a limit
    /// of the GPU.
    pub async fn create(scene: &Scene, backend: Option<String>) -> Result<Simulation, JsValue> {
        let mut options = Options::default();
        if let Some(backend) = backend {
            options.backend = backend.parse::<Backend>().map_err(thrown)?;
        }
        let inner = rockfall::Simulation::with_options_async(scene.inner.clone(), options).await.map_err(thrown)?;
        Ok(Self { inner, held: None })
    }

    /// Runs `steps` steps of `dt` seconds. Resolves with the report on all steps so far.
    ///
    /// Rejects for a time step that is not positive, when the state of a body stops being finite, and when the GPU fails.
    pub async fn run(&mut self, steps: u32, dt: f32) -> Result<Report, JsValue> {
        let mut left = steps;
        while self.held.is_some() && left > HELD_STEPS {
            self.pull().await?;
            self.inner.run_async(HELD_STEPS.into(), dt).await.map_err(thrown)?;
            left -= HELD_STEPS;
        }
        self.pull().await?;
        Ok(self.inner.run_async(left.into(), dt).await.map_err(thrown)?.into())
    }

    /// Sets how many steps a portion has at most and how many portions are under way at a time, as `Simulation::set_portions`
    /// of the crate. For `scripts/web-bench`.
    #[wasm_bindgen(js_name = setPortions, skip_typescript)]
    pub fn set_portions(&mut self, steps: u32, depth: usize) {
        self.inner.set_portions(steps.into(), depth);
    }

    /// The report on all steps so far.
    #[wasm_bindgen(getter)]
    pub fn report(&self) -> Report {
        self.inner.report().into()
    }

    /// The device that runs the simulation, for example `CPU, 1 thread`.
    #[wasm_bindgen(getter)]
    pub fn device(&self) -> String {
        self.inner.backend().device.clone()
    }

    /// `gpu` or `cpu`.
    #[wasm_bindgen(getter)]
    pub fn backend(&self) -> String {
        self.inner.backend().kind.to_string()
    }

    /// Why this backend was chosen.
    #[wasm_bindgen(getter)]
    pub fn reason(&self) -> String {
        self.inner.backend().reason.clone()
    }

    /// Number of spheres, with the ends of capsules.
    #[wasm_bindgen(getter)]
    pub fn spheres(&self) -> usize {
        self.inner.scene().counts().spheres
    }

    /// Reads the positions of all spheres in insertion order: x, y, z of each, in units.
    pub async fn positions(&mut self) -> Result<Vec<f32>, JsValue> {
        self.vectors(|sphere| sphere.position).await
    }

    /// Reads the velocities of all spheres in insertion order: x, y, z of each, in units/s.
    pub async fn velocities(&mut self) -> Result<Vec<f32>, JsValue> {
        self.vectors(|sphere| sphere.velocity).await
    }

    /// Reads the angular momenta of all spheres in insertion order: x, y, z of each, in mass units²/s.
    #[wasm_bindgen(js_name = angularMomenta)]
    pub async fn angular_momenta(&mut self) -> Result<Vec<f32>, JsValue> {
        self.vectors(|sphere| sphere.angular_momentum).await
    }

    /// Reads the orientations of all spheres in insertion order: unit quaternions x, y, z, w.
    pub async fn orientations(&mut self) -> Result<Vec<f32>, JsValue> {
        let scene = self.inner.sync_async().await.map_err(thrown)?;
        Ok(scene.spheres().iter().flat_map(|sphere| sphere.orientation.to_array()).collect())
    }

    /// Reads the state and computes its energies.
    pub async fn energy(&mut self) -> Result<Energy, JsValue> {
        self.inner.sync_async().await.map_err(thrown)?;
        let energy = self.inner.energy().map_err(thrown)?;
        Ok(Energy { kinetic: energy.kinetic, potential: energy.potential, spring: energy.spring, contact: energy.contact })
    }

    /// Returns the value of a physical constant as text, or `undefined` for an unknown name.
    pub fn setting(&self, name: &str) -> Option<String> {
        self.inner.settings().get(name)
    }

    /// Sets a physical constant from the next step on.
    ///
    /// Throws for an unknown name and for a value that is not allowed.
    #[wasm_bindgen(js_name = setSetting)]
    pub fn set_setting(&mut self, name: &str, value: &str) -> Result<(), JsValue> {
        let mut settings = *self.inner.settings();
        settings.set(name, value).map_err(thrown)?;
        self.inner.set_settings(settings).map_err(thrown)
    }

    /// Reads the state and returns it as a scene text, from which another simulation can continue.
    pub async fn snapshot(&mut self) -> Result<String, JsValue> {
        self.inner.sync_async().await.map_err(thrown)?;
        Ok(self.inner.snapshot().map_err(thrown)?.to_text())
    }

    async fn vectors(&mut self, value: impl Fn(&rockfall::Sphere) -> Vec3) -> Result<Vec<f32>, JsValue> {
        let scene = self.inner.sync_async().await.map_err(thrown)?;
        Ok(scene.spheres().iter().flat_map(|sphere| value(sphere).to_array()).collect())
    }
}

impl Drop for Simulation {
    /// Releases the memory of the GPU at once. A browser would do so only when it collects garbage.
    fn drop(&mut self) {
        if let Some(gpu) = self.inner.gpu_view() {
            gpu.gpu().device().destroy();
        }
    }
}
