//! External forces and torques of bodies under the law `rigid` (docs/physics section 11.1).

use glam::{DVec3, Vec3};

use super::{Frames, Owner};
use crate::error::Result;
use crate::scene::{RigidBody, RigidBodyId, Scene, WholeBody, finite};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;
use crate::user_laws::forces::ForceLaws;

/// The sum of the external forces on the spheres of a body, and their torque about its centre of mass.
pub(super) fn loads_of_spheres(scene: &Scene, whole: &WholeBody<'_>) -> [Vec3; 2] {
    let centre = whole.state.position.high;
    let spheres = whole.spheres.iter().filter_map(|id| scene.sphere(*id).ok());
    spheres.fold([Vec3::ZERO; 2], |[force, torque], sphere| {
        [force + sphere.force, torque + (sphere.position - centre).cross(sphere.force)]
    })
}

impl Frames {
    /// Takes over the external forces of placed bodies and loose spheres. Those of bodies with forces on their spheres stay: their
    /// torques belong to the places that the spheres had when the bodies were made.
    pub(super) fn set_loads(&mut self, scene: &Scene) {
        self.let_go();
        for (body, owner) in self.world.bodies.iter_mut().zip(&self.owners) {
            match *owner {
                Owner::Sphere(id) => body.force = scene.sphere(id).map_or(body.force, |sphere| sphere.force),
                Owner::Body(number) => {
                    let known = self.handles.declared.get(number).and_then(|id| scene.body(*id).ok());
                    if let Some(known) = known.filter(|known| !pulls_spheres(scene, known)) {
                        (body.force, body.torque) = (known.force, known.torque);
                    }
                }
                Owner::World | Owner::Motion(_) => (),
            }
        }
        self.upload_loads();
    }

    /// Takes over the forces of the program. Those of a device are those of its start.
    pub(super) fn set_laws(&mut self, forces: &ForceLaws) {
        let laws = &mut self.world.laws;
        if self.device.is_none() {
            (laws.forces, laws.base) = (forces.clone(), self.base.as_vec3().into());
        }
    }

    /// Sets the time at the start of the next frame for the forces of the program, in s.
    pub(super) fn set_law_time(&mut self, time: f64) {
        if self.world.laws.is_empty() {
            return;
        }
        self.world.laws.time = time as f32;
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &self.device {
            device.set_law_time(self.world.laws.time);
        }
    }

    /// Gives the external forces and torques of all bodies to the device.
    pub(super) fn upload_loads(&mut self) {
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &self.device {
            device.set_loads(&self.world);
        }
    }
}

/// Whether external forces act on spheres of a body.
fn pulls_spheres(scene: &Scene, body: &RigidBody) -> bool {
    body.spheres().iter().any(|id| scene.sphere(*id).is_ok_and(|sphere| sphere.force != Vec3::ZERO))
}

/// Forces on placed bodies. They act under the contact law `rigid`.
impl Simulation {
    /// Sets the external force at the centre of mass of a rigid body, in mass units/s². It acts until it is changed. Nothing is read back:
    /// a controller may do it in every step.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when the body is not in the scene, [`Error::Invalid`](crate::Error::Invalid) for
    /// a value that is not finite.
    pub fn set_body_force(&mut self, id: RigidBodyId, force: impl Into<Vec3>) -> Result<()> {
        let force = force.into();
        finite("body.force", force)?;
        self.change_loads(id, |scene| {
            scene.bodies.get_mut(id)?.force = force;
            Ok(())
        })
    }

    /// Sets the external torque about the centre of mass of a rigid body along the axes of the world, in mass units²/s². It acts until it
    /// is changed.
    ///
    /// # Errors
    /// As for [`Simulation::set_body_force`].
    pub fn set_body_torque(&mut self, id: RigidBodyId, torque: impl Into<Vec3>) -> Result<()> {
        let torque = torque.into();
        finite("body.torque", torque)?;
        self.change_loads(id, |scene| {
            scene.bodies.get_mut(id)?.torque = torque;
            Ok(())
        })
    }

    /// Adds a force at a point of a rigid body, in mass units/s², to its external force and torque. It acts until these are changed, and
    /// does not follow the point.
    ///
    /// # Errors
    /// As for [`Scene::add_body_force`] and [`Simulation::sync`].
    pub fn add_body_force(&mut self, id: RigidBodyId, force: impl Into<Vec3>, point: impl Into<DVec3>) -> Result<()> {
        self.sync_states()?;
        self.change_loads(id, |scene| scene.add_body_force(id, force, point))
    }

    /// Applies an impulse at a point of a rigid body at once, in mass units/s: the velocity changes by impulse / mass, and the angular
    /// momentum by the moment of the impulse about the centre of mass.
    ///
    /// # Errors
    /// As for [`Scene::apply_body_impulse`] and [`Simulation::sync`].
    pub fn apply_body_impulse(&mut self, id: RigidBodyId, impulse: impl Into<Vec3>, point: impl Into<DVec3>) -> Result<()> {
        self.move_bodies(|scene| scene.apply_body_impulse(id, impulse, point))
    }

    fn change_loads(&mut self, id: RigidBodyId, change: impl FnOnce(&mut Scene) -> Result<()>) -> Result<()> {
        let RigidBody { force, torque, .. } = *self.scene.body(id)?;
        change(&mut self.scene)?;
        if let Err(error) = self.scene.check_loads() {
            let body = self.scene.bodies.get_mut(id)?;
            (body.force, body.torque) = (force, torque);
            return Err(error);
        }
        self.changed_loads(id)
    }

    /// The external force or torque of a body has changed.
    pub(in crate::simulation) fn changed_loads(&mut self, id: RigidBodyId) -> Result<()> {
        if !self.has_frames() || pulls_spheres(&self.scene, self.scene.body(id)?) {
            self.dirty = self.dirty.max(Dirty::Topology);
        }
        self.loads_due = true;
        Ok(())
    }
}
