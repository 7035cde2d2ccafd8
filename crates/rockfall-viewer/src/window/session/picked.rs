//! The picked body: its motion over time and its export.

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use rockfall::glam::Vec3;
use rockfall::output::AtomicFile;
use rockfall::{Body, Error, RayHit, Scene};

use super::Session;
use crate::grasp::first_visible;
use crate::window::message::Level;
use crate::window::track::{Point, Track, motion};

impl Session {
    /// Returns the body that was picked by a click.
    pub fn picked(&self) -> Option<Body> {
        self.picked
    }

    /// Picks the first body that a ray hits, or none if it hits nothing. Returns the point where the ray enters it.
    pub fn pick(&mut self, origin: Vec3, direction: Vec3) -> Option<Vec3> {
        let hit = self.first_visible(origin, direction);
        self.set_picked(hit.map(|hit| hit.body));
        hit.map(|hit| hit.point)
    }

    /// Returns where a line of sight enters the first body that is visible. A wall in front of all spheres is drawn without its
    /// faces, so the line goes through it if there is anything behind.
    pub(super) fn first_visible(&mut self, origin: Vec3, direction: Vec3) -> Option<RayHit> {
        let hit = first_visible(&mut self.simulation, origin, direction);
        self.ok_or_report(hit).flatten()
    }

    /// Picks a body, or none. An end of a capsule picks the capsule.
    pub fn set_picked(&mut self, body: Option<Body>) {
        let body = body.map(|body| whole(self.simulation.scene(), body));
        if self.picked != body {
            self.picked = body;
            self.track = self.recorded_track();
            self.follow(true);
        }
        self.sample(true);
    }

    /// Returns the motion of the picked body in the recorded states up to now.
    fn recorded_track(&self) -> Track {
        let mut track = Track::default();
        let steps = self.simulation.report().steps;
        for state in self.past.states().filter(|state| state.report.steps < steps) {
            if let Some((position, velocity)) = self.picked.and_then(|body| motion(&state.scene, body)) {
                track.add(Point { time: state.report.time, position, velocity }, self.now, 0.0);
            }
        }
        track
    }

    /// Returns the motion of the picked body.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// Adds the present state of the picked body to its motion, unless reading it back takes too long to do it so often.
    /// `forced` adds it anyway.
    pub(super) fn follow(&mut self, forced: bool) {
        let Some(body) = self.picked.filter(|body| matches!(body, Body::Sphere(_) | Body::Rod(_))) else {
            return;
        };
        if self.device_failed || !(forced || self.track.is_due(self.wall_time())) {
            return;
        }
        let (start, time) = (Instant::now(), self.simulation.report().time);
        let found = self.simulation.sync().map(|scene| motion(scene, body));
        if let Some((position, velocity)) = self.ok_or_report(found).flatten() {
            let now = self.wall_time();
            self.track.add(Point { time, position, velocity }, now, start.elapsed().as_secs_f64());
        }
    }

    /// Unit vector against gravity.
    pub fn up(&self) -> Vec3 {
        -self.settings().gravity_direction.try_normalize().unwrap_or(Vec3::NEG_Y)
    }

    /// Writes the motion of the picked body as CSV, and returns whether that was possible.
    pub fn save_track(&mut self, path: &Path) -> bool {
        let text = self.track.csv(self.up());
        let write = || {
            let mut file = AtomicFile::create(path)?;
            file.write_all(text.as_bytes())?;
            file.commit()
        };
        let written = write().map_err(|source| Error::File { file: path.to_owned(), source });
        let written = self.ok_or_report(written).is_some();
        if written {
            self.tell(Level::Note, format!("saved as {}", path.display()));
        }
        written
    }
}

/// Returns the rod of a capsule for its end spheres, and other bodies as they are.
fn whole(scene: &Scene, body: Body) -> Body {
    let capsule = scene.capsules().iter().find(|parts| body == Body::Sphere(parts.end1) || body == Body::Sphere(parts.end2));
    capsule.map_or(body, |parts| Body::Rod(parts.rod))
}
