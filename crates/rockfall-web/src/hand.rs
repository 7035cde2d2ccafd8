//! Bodies that are held, dragged and thrown.

use rockfall::glam::Vec3;
use rockfall::{Body, ContactLaw, SphereId};
use rockfall_viewer::grasp::{anchor, connected, first_visible, free_place, holding_tether, nearer_end, reach, thrown as ball};
use wasm_bindgen::prelude::*;

use crate::errors::thrown;
use crate::simulation::{Held, Simulation, Tied};

#[wasm_bindgen]
impl Simulation {
    /// Holds the first visible body in the direction dx, dy, dz from x, y, z in units. Resolves with the point where the ray
    /// enters it, or with `undefined` if there is no body that can move. A rod is held at its nearer end.
    #[allow(clippy::too_many_arguments)]
    pub async fn hold(&mut self, x: f32, y: f32, z: f32, dx: f32, dy: f32, dz: f32) -> Result<Option<Vec<f32>>, JsValue> {
        self.release()?;
        self.inner.sync_async().await.map_err(thrown)?;
        let hit = first_visible(&mut self.inner, Vec3::new(x, y, z), Vec3::new(dx, dy, dz)).map_err(thrown)?;
        let Some(hit) = hit else { return Ok(None) };
        let scene = self.inner.scene();
        let id: SphereId = match hit.body {
            Body::Sphere(id) => id,
            Body::Rod(id) => nearer_end(scene, id, hit.point).map_err(thrown)?,
            _ => return Ok(None),
        };
        let sphere = *scene.sphere(id).map_err(thrown)?;
        if sphere.fixed {
            return Ok(None);
        }
        if scene.contact_law() == ContactLaw::Rigid {
            let Some(grip) = self.inner.grip(hit.body, hit.point).map_err(thrown)? else { return Ok(None) };
            self.inner.pull_grip(&grip, hit.point).map_err(thrown)?;
            self.held = Some(Held::Grip(grip));
            return Ok(Some(hit.point.to_array().to_vec()));
        }
        let connected = connected(scene, id).len();
        let tether = holding_tether(scene, id, &sphere, self.inner.time_step());
        let tether = self.inner.add_tether(tether).map_err(thrown)?;
        let offset = sphere.position - hit.point;
        self.held = Some(Held::Tether(Tied { sphere: id, tether, connected, goal: sphere.position, offset }));
        Ok(Some(hit.point.to_array().to_vec()))
    }

    /// Drags the held body, if any, so that the grabbed point moves to x, y, z in units during the next steps.
    pub fn drag(&mut self, x: f32, y: f32, z: f32) -> Result<(), JsValue> {
        let pointer = Vec3::new(x, y, z);
        match &mut self.held {
            Some(Held::Tether(held)) => held.goal = pointer + held.offset,
            Some(Held::Grip(grip)) => self.inner.pull_grip(grip, pointer).map_err(thrown)?,
            None => (),
        }
        Ok(())
    }

    /// Releases the held body, if any.
    pub fn release(&mut self) -> Result<(), JsValue> {
        match self.held.take() {
            Some(Held::Tether(held)) => self.inner.remove_tether(held.tether).map_err(thrown),
            Some(Held::Grip(_)) => {
                self.inner.release_grip();
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Adds a sphere of the mean size and density of the scene at x, y, z in units, with the velocity vx, vy, vz in units/s.
    /// Resolves with whether there was room for it.
    #[wasm_bindgen(js_name = throwBall)]
    #[allow(clippy::too_many_arguments)]
    pub async fn throw_ball(&mut self, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32) -> Result<bool, JsValue> {
        let scene = self.inner.sync_async().await.map_err(thrown)?;
        let mut sphere = ball(scene, Vec3::new(x, y, z), Vec3::new(vx, vy, vz));
        let Some(place) = free_place(scene, &sphere) else { return Ok(false) };
        sphere.position = place;
        self.inner.add_sphere(sphere).map_err(thrown)?;
        Ok(true)
    }
}

impl Simulation {
    /// Moves the point of the tether of the held body, if any, towards its goal, as far as its force may grow.
    pub(crate) async fn pull(&mut self) -> Result<(), JsValue> {
        let Some(Held::Tether(Tied { sphere, tether, connected, goal, .. })) = self.held else { return Ok(()) };
        let scene = self.inner.sync_async().await.map_err(thrown)?;
        let sphere = scene.sphere(sphere).map_err(thrown)?;
        let point = anchor(sphere, goal, reach(scene, sphere, connected));
        self.inner.update_tether(tether, |tether| tether.point = point).map_err(thrown)
    }
}
