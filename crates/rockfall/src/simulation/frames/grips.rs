//! Points of bodies that the program pulls, for example with a pointer (docs/physics section 11.15).

use glam::{DVec3, Vec3};

use super::{Frames, Owner};
use crate::error::{Error, Result};
use crate::rigid::grip::pull;
use crate::scene::{Body, Scene, SphereId};
use crate::simulation::Simulation;

/// A point of a body that moves under the contact law `rigid`: see [`Simulation::grip`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    sphere: SphereId,
    /// From the centre of mass, in coordinates of the body.
    place: Vec3,
}

impl Grip {
    /// The sphere that is the body, or a sphere that is part of it.
    pub fn sphere(&self) -> SphereId {
        self.sphere
    }
}

/// The bodies on which a grip acts in the present frame, with their own external forces and torques.
pub(super) type Pulled = Vec<(u32, [Vec3; 2])>;

impl Frames {
    /// The number of the body that a sphere is or belongs to. `None` if it is fixed or not known.
    fn body_of(&self, scene: &Scene, sphere: SphereId) -> Option<u32> {
        let declared = &self.handles.declared;
        let owner = if let Some(body) = scene.body_of_sphere(sphere) {
            Owner::Body(declared.iter().position(|other| *other == body)?)
        } else if let Some(body) = scene.implied_of(sphere) {
            Owner::Body(declared.len() + self.handles.implied.iter().position(|other| *other == body)?)
        } else {
            Owner::Sphere(sphere)
        };
        let number = self.owners.iter().position(|other| *other == owner)?;
        Some(number as u32)
    }

    /// Lets a grip pull in the next frame of `dt` seconds. The states of the bodies must be known.
    pub(super) fn pull(&mut self, scene: &Scene, grip: &Grip, goal: DVec3, dt: f32) {
        self.let_go();
        let Some(body) = self.body_of(scene, grip.sphere) else { return };
        let loads = pull(&self.world, (body, grip.place.as_dvec3()), goal - self.base, dt.into());
        for (number, [force, torque]) in loads {
            let body = &mut self.world.bodies[number as usize];
            self.pulled.push((number, [body.force, body.torque]));
            body.force += force.as_vec3();
            body.torque += torque.as_vec3();
        }
    }

    /// Takes the forces of the last frame's grip back. Returns whether there were any.
    pub(super) fn let_go(&mut self) -> bool {
        let was_pulled = !self.pulled.is_empty();
        for (number, [force, torque]) in self.pulled.drain(..) {
            let body = &mut self.world.bodies[number as usize];
            (body.force, body.torque) = (force, torque);
        }
        was_pulled
    }
}

/// Pulling a body by a point. The contact law is `rigid`.
impl Simulation {
    /// Takes hold of a body at a point of the scene, in units. A rod that no body has as a part is held at the nearer end that moves.
    /// `None` for what does not move.
    ///
    /// # Errors
    /// [`Error::Invalid`] with another contact law than `rigid`. Otherwise as for [`Simulation::sync`].
    pub fn grip(&mut self, body: Body, point: Vec3) -> Result<Option<Grip>> {
        if !self.has_frames() {
            let value = format!("{} with a grip", self.scene.contact_law());
            return Err(Error::Invalid { field: "contact_law", value, expected: "rigid, or a tether in place of the grip" });
        }
        self.sync()?;
        if self.frames.is_none() || self.frames_due {
            self.renew_frames()?;
        }
        let Some(frames) = &self.frames else { return Ok(None) };
        let sphere = match body {
            Body::Sphere(id) => id,
            Body::Rod(id) => {
                let rod = self.scene.rod(id)?;
                end_of(&self.scene, [rod.end1, rod.end2], point)?
            }
            _ => return Ok(None),
        };
        let Some(number) = frames.body_of(&self.scene, sphere) else { return Ok(None) };
        let is_loose = matches!(frames.owners[number as usize], Owner::Sphere(_)) && matches!(body, Body::Rod(_));
        let inner = frames.world.bodies[number as usize].pose.inner((point.as_dvec3() - frames.base).as_vec3());
        Ok(Some(Grip { sphere, place: if is_loose { Vec3::ZERO } else { inner } }))
    }

    /// Where the point of a grip is, in units. `None` if its body was removed.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn grip_point(&mut self, grip: &Grip) -> Result<Option<Vec3>> {
        self.sync()?;
        if self.frames.is_none() || self.frames_due {
            self.renew_frames()?;
        }
        let Some(frames) = &self.frames else { return Ok(None) };
        let body = frames.body_of(&self.scene, grip.sphere).map(|number| frames.world.bodies[number as usize].pose);
        Ok(body.map(|pose| (frames.base + pose.point(grip.place).as_dvec3()).as_vec3()))
    }

    /// Pulls the point of a grip towards a goal in every step from now on, with a force that follows from the mass at the point and takes
    /// it there in about half a second. It replaces the pull before. It is not part of the scene and of checkpoints.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a goal that is not finite.
    pub fn pull_grip(&mut self, grip: &Grip, goal: Vec3) -> Result<()> {
        crate::scene::finite("goal", goal)?;
        self.pulls = Some((*grip, goal));
        Ok(())
    }

    /// Ends the pull of [`Simulation::pull_grip`].
    pub fn release_grip(&mut self) {
        self.pulls = None;
    }

    /// Gives the forces of the grip to the bodies, before a frame.
    pub(super) fn pull_in(&self, frames: &mut Frames) -> Result<()> {
        let changed = match self.pulls {
            Some((grip, goal)) => {
                frames.fetch()?;
                frames.pull(&self.scene, &grip, goal.as_dvec3(), self.time_step);
                true
            }
            None => frames.let_go(),
        };
        if changed {
            frames.upload_loads();
        }
        Ok(())
    }
}

/// The end of a rod that is nearer to a point, or the other one if that is fixed.
fn end_of(scene: &Scene, ends: [SphereId; 2], point: Vec3) -> Result<SphereId> {
    let [one, other] = [scene.sphere(ends[0])?, scene.sphere(ends[1])?];
    let is_first = one.position.distance_squared(point) <= other.position.distance_squared(point);
    Ok(ends[usize::from(if is_first { one.fixed } else { !other.fixed })])
}
