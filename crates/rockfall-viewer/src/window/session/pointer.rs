//! Picks, holds, drags and throws bodies with the pointer.

use rockfall::glam::Vec3;
use rockfall::{Body, ContactLaw, Sphere, SphereId};

use super::Session;
use crate::grasp::{anchor, connected, free_place, holding_tether, nearer_end, reach, settle, thrown};
use crate::window::hold::{Held, Hold, Sight};
use crate::window::message::Level;

impl Session {
    /// Connects the first body in the line of sight to the pointer. A rod is held at the nearer end that is not fixed.
    pub fn hold(&mut self, sight: &Sight) {
        self.release();
        let Some(hit) = self.first_visible(sight.origin, sight.direction) else {
            return;
        };
        self.set_picked(Some(hit.body));
        let scene = self.simulation.scene();
        let place = |id: SphereId| scene.sphere(id).map(|sphere| (id, *sphere));
        let grabbed = match hit.body {
            Body::Sphere(id) => place(id),
            Body::Rod(id) => nearer_end(scene, id, hit.point).and_then(place),
            _ => {
                self.tell(Level::Note, "boxes and polygons never move, so they cannot be held");
                return;
            }
        };
        let Some((id, sphere)) = self.ok_or_report(grabbed) else {
            return;
        };
        if sphere.fixed {
            self.tell(Level::Note, "this sphere is fixed, so it cannot be held");
            return;
        }
        let before = self.state_for_undo();
        let by = if self.simulation.scene().contact_law() == ContactLaw::Rigid {
            let grip = self.simulation.grip(hit.body, hit.point);
            self.ok_or_report(grip).flatten().map(Hold::Grip)
        } else {
            self.tie(id, &sphere, hit.point)
        };
        let Some(by) = by else { return };
        self.before_hold = before;
        let depth = (hit.point - sight.origin).dot(sight.forward);
        self.held = Some(Held { sphere: id, pointer: hit.point, by, depth });
        self.pull();
    }

    fn tie(&mut self, id: SphereId, sphere: &Sphere, grabbed: Vec3) -> Option<Hold> {
        let tether = holding_tether(self.simulation.scene(), id, sphere, self.pace.time_step);
        let added = self.simulation.add_tether(tether);
        let tether = self.ok_or_report(added)?;
        let connected = connected(self.simulation.scene(), id);
        Some(Hold::Tether { tether, connected, offset: sphere.position - grabbed })
    }

    /// Moves the anchor of the held body to the present position of the pointer.
    pub fn drag(&mut self, sight: &Sight) {
        let Some(held) = &mut self.held else {
            return;
        };
        held.pointer = sight.at_depth(held.depth);
        self.pull();
    }

    /// Lets the grabbed point follow the pointer. The point of a tether moves towards it as far as the force may grow.
    fn pull(&mut self) {
        let Some(Held { sphere, pointer, by, .. }) = &self.held else { return };
        let pulled = match by {
            Hold::Grip(grip) => self.simulation.pull_grip(grip, *pointer),
            Hold::Tether { tether, connected, offset } => {
                let point = self.simulation.sync().and_then(|scene| {
                    let sphere = scene.sphere(*sphere)?;
                    Ok(anchor(sphere, *pointer + *offset, reach(scene, sphere, connected.len())))
                });
                point.and_then(|point| self.simulation.update_tether(*tether, |tether| tether.point = point))
            }
        };
        if self.ok_or_report(pulled).is_none() {
            self.held = None;
        }
    }

    /// Damps the held body after this number of steps, so that it comes to rest at the pointer, and pulls it on.
    pub(super) fn settle_held(&mut self, steps: u64) {
        if let Some(Held { pointer, by: Hold::Tether { connected, offset, .. }, .. }) = &self.held {
            let seconds = steps as f32 * self.pace.time_step;
            let settled = settle(&mut self.simulation, connected, *pointer + *offset, seconds);
            self.ok_or_report(settled);
            self.pull();
        }
    }

    /// Releases the held body.
    pub fn release(&mut self) {
        if let Some(held) = self.held.take() {
            self.simulation.release_grip();
            let removed = held.tether().map_or(Ok(()), |tether| self.simulation.remove_tether(tether));
            self.ok_or_report(removed);
            let steps = self.simulation.report().steps;
            let before = self.before_hold.take();
            if before.as_ref().is_none_or(|before| before.report.steps < steps) {
                self.edited_state("pull", before);
            }
        }
    }

    /// Adds a sphere at `origin` with this velocity. It has the mean size and density of the spheres of the scene. If another
    /// body is there, it starts at the next free place along its way.
    pub fn throw(&mut self, origin: Vec3, velocity: Vec3) {
        let synced = self.simulation.sync().map(drop);
        if self.ok_or_report(synced).is_none() {
            return;
        }
        let mut sphere = thrown(self.simulation.scene(), origin, velocity);
        let Some(place) = free_place(self.simulation.scene(), &sphere) else {
            self.tell(Level::Warning, "there is no room for another sphere here");
            return;
        };
        sphere.position = place;
        let before = self.state_for_undo();
        let added = self.simulation.add_sphere(sphere);
        let Some(added) = self.ok_or_report(added) else {
            return;
        };
        // A sphere that the simulation refuses would stop every later step.
        let accepted = self.simulation.flush();
        if self.ok_or_report(accepted).is_none() {
            let removed = self.simulation.remove_sphere(added);
            self.ok_or_report(removed);
        } else {
            self.objects_version += 1;
            self.edited_state("throw", before);
            if !self.running {
                self.tell(Level::Note, "the sphere flies as soon as the simulation runs (space)");
            }
        }
    }

    /// Returns the point where a line of sight enters the first visible body.
    pub fn look(&mut self, sight: &Sight) -> Option<Vec3> {
        self.first_visible(sight.origin, sight.direction).map(|hit| hit.point)
    }
}
