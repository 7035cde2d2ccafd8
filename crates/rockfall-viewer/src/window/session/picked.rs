//! The picked body: its motion over time and its export.

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use rockfall::glam::Vec3;
use rockfall::output::AtomicFile;
use rockfall::{Body, Error, RayHit, SphereId};

use super::Session;
use crate::grasp::first_visible;
use crate::plot::{self, COLOURS};
use crate::whole::{motion, whole};
use crate::window::message::Level;
use crate::window::track::{Point, Track};

/// Number of bodies that stay in the plots.
pub const MOST_KEPT: usize = COLOURS.len() - 1;

/// A body that stays in the plots when another one is picked.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The body.
    pub body: Body,
    /// Its name.
    pub title: String,
    /// Its motion.
    pub track: Track,
}

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

    /// Picks a body, or none. An end of a capsule picks the capsule, a part of a rigid body the rigid body.
    pub fn set_picked(&mut self, body: Option<Body>) {
        let body = body.map(|body| whole(self.simulation.scene(), body));
        if self.picked != body {
            self.picked = body;
            self.track = self.recorded_track();
            self.follow(true);
        }
        self.sample(true);
    }

    /// Returns the bodies that stay in the plots beside the picked one.
    pub fn kept(&self) -> impl Iterator<Item = &Kept> {
        self.kept.iter().filter(|kept| Some(kept.body) != self.picked)
    }

    /// Whether the picked body stays in the plots.
    pub fn is_kept(&self) -> bool {
        self.kept.iter().any(|kept| Some(kept.body) == self.picked)
    }

    /// Keeps the picked body in the plots, or takes it out again.
    pub fn toggle_kept(&mut self) {
        let Some(body) = self.picked else { return };
        if self.is_kept() {
            self.kept.retain(|kept| kept.body != body);
            return;
        }
        let title = self.watch.facts().map_or_else(String::new, |facts| facts.title.clone());
        self.kept.insert(0, Kept { body, title, track: self.track.clone() });
        self.kept.truncate(MOST_KEPT);
    }

    /// Picks the first of some spheres, and keeps the others in the plots beside it.
    pub fn set_plotted(&mut self, spheres: &[SphereId]) {
        self.kept.clear();
        for (place, sphere) in spheres.iter().enumerate().rev() {
            self.set_picked(Some(Body::Sphere(*sphere)));
            if place > 0 && !self.is_kept() {
                self.toggle_kept();
            }
        }
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
        let body = self.picked.filter(|body| matches!(body, Body::Sphere(_) | Body::Rod(_)));
        if body.is_none() && self.kept.is_empty() || self.device_failed || !(forced || self.track.is_due(self.wall_time())) {
            return;
        }
        let (start, time) = (Instant::now(), self.simulation.report().time);
        let synced = self.simulation.sync().map(drop);
        if self.ok_or_report(synced).is_none() {
            return;
        }
        let (now, seconds, scene) = (self.wall_time(), start.elapsed().as_secs_f64(), self.simulation.scene());
        let kept = self.kept.iter_mut().map(|kept| (kept.body, &mut kept.track));
        for (body, track) in kept.chain(body.map(|body| (body, &mut self.track))) {
            if let Some((position, velocity)) = motion(scene, body) {
                track.add(Point { time, position, velocity }, now, seconds);
            }
        }
    }

    /// Unit vector against gravity.
    pub fn up(&self) -> Vec3 {
        plot::up(self.simulation.scene())
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
