//! The places of the spheres on the host, for text, arrows and trails.

use std::collections::{HashSet, VecDeque};

use rockfall::glam::Vec3;
use rockfall::{Result, Scene, Simulation, Sphere, SphereDiagnostics, SphereId};

use crate::draw::net_force;
use crate::draw::range::{RecentPercentile, percentile};
use crate::palette::Rgb;
use crate::plot::{Graph, Plots};
use crate::tags::colour_of;

/// Number of spheres that have trails. In larger scenes only some have.
const MOST_TRAILS: usize = 1000;
/// Number of states during the time of the trails.
const STATES: f64 = 200.0;
/// Greatest number of past states that are kept. Pictures add some to those that trails need.
const MOST_STATES: usize = 1000;

/// A vector of every sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrows {
    /// Velocity, in units/s.
    Velocity,
    /// Net force, with that of rods of fixed length, in mass units/s².
    Force,
    /// Weight, in mass units/s².
    Gravity,
}

impl Arrows {
    /// All values.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Force, Self::Gravity];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Force => "force",
            Self::Gravity => "gravity",
        }
    }

    /// Returns the vector with this name.
    ///
    /// # Errors
    /// A text with the names, if this is none of them.
    pub fn named(name: &str) -> std::result::Result<Self, String> {
        let found = Self::ALL.into_iter().find(|arrows| arrows.name() == name);
        found.ok_or_else(|| format!("expected one of: {}", Self::ALL.map(Self::name).join(", ")))
    }

    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::Velocity => "units/s",
            Self::Force | Self::Gravity => "mass units/s²",
        }
    }

    pub(crate) fn of(self, sphere: &Sphere, values: Option<&SphereDiagnostics>, gravity: Vec3) -> Vec3 {
        match self {
            Self::Velocity => sphere.velocity,
            Self::Force => values.map_or(Vec3::ZERO, |values| values.net_force),
            // A fixed sphere is held, so that gravity does not act on it.
            Self::Gravity if sphere.fixed => Vec3::ZERO,
            Self::Gravity => sphere.mass * gravity,
        }
    }
}

/// What an overlay shows of the spheres, between the last two states of a renderer.
#[derive(Debug, Default)]
pub struct Motion {
    wanted: bool,
    arrows: Option<Arrows>,
    seconds: f64,
    before: State,
    now: State,
    /// How much the state before is shown, from 0 to 1.
    back: f32,
    labels: Vec<String>,
    /// Radii, and colours that the scene gives, of all spheres.
    looks: Vec<(f32, Option<Rgb>)>,
    /// [`Scene::tag_changes`] of the labels and colours.
    tag_changes: u64,
    recent: RecentPercentile,
    past: VecDeque<State>,
    pub(crate) plots: Plots,
}

#[derive(Clone, Debug, Default)]
struct State {
    time: f64,
    places: Vec<Vec3>,
    arrows: Vec<Vec3>,
}

impl Motion {
    /// Takes whether places are needed, the vectors that arrows show, and the length of trails in s.
    pub(crate) fn want(&mut self, places: bool, arrows: Option<Arrows>, trails: f64) {
        if (self.arrows, self.seconds) != (arrows, trails) {
            self.recent = RecentPercentile::default();
            self.past.clear();
        }
        (self.wanted, self.arrows, self.seconds) = (places, arrows, trails);
    }

    /// Forgets past states, before another scene is shown.
    pub(crate) fn forget(&mut self) {
        self.recent = RecentPercentile::default();
        self.past.clear();
        self.labels.clear();
    }

    /// Takes the present state.
    pub(crate) fn update(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.now.time = simulation.report().time;
        self.plots.update(simulation)?;
        if !self.wanted {
            self.now.places.clear();
            return Ok(());
        }
        let values = if self.arrows == Some(Arrows::Force) { net_force::diagnostics(simulation)? } else { Vec::new() };
        let scene = simulation.sync()?;
        self.now.places = scene.spheres().iter().map(|sphere| sphere.position).collect();
        if let Some(arrows) = self.arrows {
            let gravity = scene.settings.gravity * scene.settings.gravity_direction;
            let spheres = scene.spheres().iter().enumerate();
            self.now.arrows = spheres.map(|(index, sphere)| arrows.of(sphere, values.get(index), gravity)).collect();
            self.recent.record(percentile(self.now.arrows.iter().map(|arrow| arrow.length())));
        }
        if self.labels.len() != self.now.places.len() || self.tag_changes != scene.tag_changes() {
            (self.labels, self.tag_changes) = (labels(scene), scene.tag_changes());
            self.looks = scene.sphere_ids().zip(scene.spheres()).map(|(id, it)| (it.radius, colour_of(scene, id))).collect();
        }
        Ok(())
    }

    /// Takes the plots that are shown of the following states.
    pub fn set_plots(&mut self, graphs: Vec<Graph>) {
        self.plots = Plots::new(graphs);
    }

    /// Sets the time of the present state, which a trajectory knows and its simulation does not.
    pub(crate) fn set_time(&mut self, time: f64) {
        self.now.time = time;
    }

    pub(crate) fn remember(&mut self) {
        self.before = self.now.clone();
        self.plots.remember();
    }

    pub(crate) fn set_blend(&mut self, blend: f32) {
        self.back = 1.0 - blend;
    }

    /// Adds the state that is shown to the plots and the trails.
    pub(crate) fn record(&mut self) {
        self.plots.record(self.time(), f64::from(self.back));
        if self.seconds <= 0.0 || !self.wanted {
            return;
        }
        let state = State { time: self.time(), places: self.places().collect(), arrows: Vec::new() };
        let is_later = self.past.back().is_none_or(|last| last.time < state.time && last.places.len() == state.places.len());
        if !is_later {
            // The same state again, or another run.
            let is_same = self.past.back().is_some_and(|last| last.time == state.time && last.places == state.places);
            if is_same {
                return;
            }
            self.past.clear();
        }
        self.past.push_back(state);
        let oldest = self.time() - self.seconds;
        while self.past.len() > MOST_STATES || self.past.get(1).is_some_and(|state| state.time <= oldest) {
            self.past.pop_front();
        }
    }

    /// Time between the states that trails and plots need, in s; `None` without them.
    pub fn interval(&self) -> Option<f64> {
        let trails = (self.wanted && self.seconds > 0.0).then(|| self.seconds / STATES);
        trails.into_iter().chain(self.plots.interval()).reduce(f64::min)
    }

    /// The plots.
    pub fn plots(&self) -> &Plots {
        &self.plots
    }

    fn is_between(&self) -> bool {
        self.back > 0.0 && self.before.places.len() == self.now.places.len()
    }

    /// The time that is shown, in s.
    pub fn time(&self) -> f64 {
        let back = f64::from(self.back);
        if back > 0.0 { self.now.time + back * (self.before.time - self.now.time) } else { self.now.time }
    }

    fn places(&self) -> impl Iterator<Item = Vec3> {
        let between = |index: usize, now: Vec3| match self.is_between() {
            true => now.lerp(self.before.places[index], self.back),
            false => now,
        };
        self.now.places.iter().enumerate().map(move |(index, now)| between(index, *now))
    }

    pub(crate) fn arrows(&self) -> impl Iterator<Item = (Vec3, Vec3)> {
        let between = |index: usize, now: Vec3| match self.is_between() && self.before.arrows.len() == self.now.arrows.len() {
            true => now.lerp(self.before.arrows[index], self.back),
            false => now,
        };
        let arrows = self.now.arrows.iter().enumerate().map(move |(index, now)| between(index, *now));
        self.places().zip(arrows)
    }

    /// Places, radii and texts.
    pub(crate) fn labels(&self) -> impl Iterator<Item = (Vec3, f32, &str)> {
        let labels = self.labels.iter().map(String::as_str).zip(&self.looks);
        let all = self.places().zip(labels).map(|(place, (label, (radius, _)))| (place, *radius, label));
        all.filter(|(.., label)| !label.is_empty())
    }

    /// A round number above the 99th percentile of the lengths of the arrows of the last states.
    pub fn arrow_key(&self) -> f32 {
        self.recent.range()[1]
    }

    /// The places of the spheres in the states of the trails, the oldest first.
    pub fn past(&self) -> impl Iterator<Item = &[Vec3]> {
        self.past.iter().map(|state| state.places.as_slice())
    }

    /// The lines between past places, with their age from 0 to 1 and the colour that the scene gives to the sphere, the oldest first.
    pub(crate) fn trails(&self) -> impl Iterator<Item = ([Vec3; 2], f32, Option<Rgb>)> {
        let (end, seconds) = (self.time(), self.seconds.max(f64::MIN_POSITIVE));
        let pairs = self.past.iter().zip(self.past.iter().skip(1));
        pairs.flat_map(move |(from, to)| {
            let age = ((end - to.time) / seconds).clamp(0.0, 1.0) as f32;
            let stride = to.places.len().div_ceil(MOST_TRAILS).max(1);
            let ends = from.places.iter().zip(&to.places).enumerate().step_by(stride).filter(|(_, (from, to))| from != to);
            ends.map(move |(body, (from, to))| ([*from, *to], age, self.looks.get(body).and_then(|(_, colour)| *colour)))
        })
    }
}

/// The texts beside the spheres: their labels, or in a scene that says nothing of labels their numbers, which are references, or in a scene
/// without references the order of addition. The label of a capsule is at its first end.
fn labels(scene: &Scene) -> Vec<String> {
    let has_references = scene.sphere_ids().any(|sphere| scene.reference(sphere).is_some());
    let label_of = |sphere: SphereId| scene.tag(sphere).ok().flatten()?.label.clone();
    let second: HashSet<SphereId> = scene.capsules().iter().map(|parts| parts.end2).collect();
    let has_labels = scene.sphere_ids().any(|sphere| label_of(sphere).is_some());
    let label = |(index, sphere): (usize, SphereId)| match label_of(sphere) {
        Some(_) if second.contains(&sphere) => String::new(),
        Some(label) => label,
        None if has_labels => String::new(),
        None if has_references => scene.reference(sphere).map_or_else(String::new, |reference| reference.to_string()),
        None => index.to_string(),
    };
    scene.sphere_ids().enumerate().map(label).collect()
}
