//! The places of the bodies on the host, for text, arrows and trails.

use std::collections::VecDeque;

use rockfall::glam::Vec3;
use rockfall::{Body, Counts, ObjectId, Result, Scene, Simulation, SphereDiagnostics};

use crate::draw::net_force;
use crate::draw::range::{RecentPercentile, percentile};
use crate::joints::{JointPlace, places};
use crate::palette::Rgb;
use crate::plot::{Graph, Plots};
use crate::tags::{colour_of, name_of, object_of};
use crate::whole::{motion, spheres, thickness, wholes};

/// Number of bodies that have trails. In larger scenes only some have.
const MOST_TRAILS: usize = 1000;
/// Number of states during the time of the trails.
const STATES: f64 = 200.0;
/// Greatest number of past states that are kept. Pictures add some to those that trails need.
const MOST_STATES: usize = 1000;

/// A vector of every body.
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

    /// The vector of a body; `values` are those of all spheres.
    fn of(self, scene: &Scene, body: Body, values: &[SphereDiagnostics]) -> Vec3 {
        let parts = || spheres(scene, body);
        let force = |id| Some(values.get(Body::Sphere(id).index(scene).ok()?)?.net_force);
        // A fixed sphere is held, so that gravity does not act on it.
        let mass = |id| scene.sphere(id).ok().filter(|sphere| !sphere.fixed).map(|sphere| sphere.mass);
        match self {
            Self::Velocity => motion(scene, body).map_or(Vec3::ZERO, |(_, velocity)| velocity),
            Self::Force => parts().filter_map(force).sum(),
            Self::Gravity => parts().filter_map(mass).sum::<f32>() * scene.settings.gravity * scene.settings.gravity_direction,
        }
    }
}

/// What an overlay shows of the bodies, between the last two states of a renderer.
#[derive(Debug, Default)]
pub struct Motion {
    wanted: bool,
    /// Whether all joints are shown, and not only distance joints.
    all_joints: bool,
    arrows: Option<Arrows>,
    seconds: f64,
    before: State,
    now: State,
    /// How much the state before is shown, from 0 to 1.
    back: f32,
    /// The bodies, and what is drawn of each besides its place.
    bodies: Vec<Body>,
    looks: Vec<Appearance>,
    /// The numbers of objects and [`Scene::tag_changes`] that the bodies belong to.
    counts: Counts,
    tag_changes: u64,
    recent: RecentPercentile,
    past: VecDeque<State>,
    pub(crate) plots: Plots,
}

/// What is drawn of a body besides its place.
#[derive(Clone, Debug)]
struct Appearance {
    label: String,
    /// How far the body reaches from its centre in all directions.
    radius: f32,
    /// The colour that the scene gives.
    colour: Option<Rgb>,
    /// The index of its first sphere.
    first: usize,
    /// The name that the scene gives, and the number: the reference or the index of the first sphere.
    name: Option<String>,
    number: String,
}

impl Appearance {
    /// Whether the body is one of those with these names or numbers. An empty list stands for all bodies.
    fn is_one_of(&self, names: &[String]) -> bool {
        names.is_empty() || names.iter().any(|name| self.name.as_ref() == Some(name) || self.number == *name)
    }
}

#[derive(Clone, Debug, Default)]
struct State {
    time: f64,
    places: Vec<Vec3>,
    arrows: Vec<Vec3>,
    joints: Vec<JointPlace>,
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

    /// Takes whether all joints are shown, and not only distance joints.
    pub(crate) fn want_joints(&mut self, all: bool) {
        self.all_joints = all;
    }

    /// Forgets past states, before another scene is shown.
    pub(crate) fn forget(&mut self) {
        self.recent = RecentPercentile::default();
        self.past.clear();
        self.bodies.clear();
    }

    /// Takes the present state.
    pub(crate) fn update(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.now.time = simulation.report().time;
        self.plots.update(simulation)?;
        self.now.joints = places(simulation, self.all_joints)?;
        if !self.wanted {
            self.now.places.clear();
            return Ok(());
        }
        let values = if self.arrows == Some(Arrows::Force) { net_force::diagnostics(simulation)? } else { Vec::new() };
        let scene = simulation.sync()?;
        if self.bodies.is_empty() || (self.counts, self.tag_changes) != (scene.counts(), scene.tag_changes()) {
            (self.counts, self.tag_changes) = (scene.counts(), scene.tag_changes());
            self.bodies = wholes(scene);
            self.looks = appearances(scene, &self.bodies);
        }
        let place = |body: &Body| motion(scene, *body).map_or(Vec3::NAN, |(place, _)| place);
        self.now.places = self.bodies.iter().map(place).collect();
        if let Some(arrows) = self.arrows {
            self.now.arrows = self.bodies.iter().map(|body| arrows.of(scene, *body, &values)).collect();
            self.recent.record(percentile(self.now.arrows.iter().map(|arrow| arrow.length())));
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
        let state = State { time: self.time(), places: self.places().collect(), ..State::default() };
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

    /// Where the joints are that are shown.
    pub(crate) fn joints(&self) -> impl Iterator<Item = JointPlace> {
        let is_between = self.back > 0.0 && self.before.joints.len() == self.now.joints.len();
        let between = move |(index, now): (usize, &JointPlace)| match is_between {
            true => now.towards(&self.before.joints[index], self.back),
            false => *now,
        };
        self.now.joints.iter().enumerate().map(between)
    }

    /// The ends of distance joints.
    pub(crate) fn strings(&self) -> Vec<[Vec3; 2]> {
        self.joints().filter(|joint| joint.is_string).map(|joint| joint.ends).collect()
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
        let all = self.places().zip(&self.looks).filter(|(_, look)| !look.label.is_empty());
        all.map(|(place, look)| (place, look.radius, look.label.as_str()))
    }

    /// A round number above the 99th percentile of the lengths of the arrows of the last states.
    pub fn arrow_key(&self) -> f32 {
        self.recent.range()[1]
    }

    /// The places of the bodies with these names or numbers (none for all) in the states of the trails, the oldest first, each with the
    /// index of the first sphere of the body.
    pub fn past(&self, names: &[String]) -> impl Iterator<Item = impl Iterator<Item = (usize, Vec3)>> {
        let states = self.past.iter().filter(|state| state.places.len() == self.looks.len());
        states.map(move |state| {
            let bodies = self.looks.iter().zip(&state.places).filter(|(look, _)| look.is_one_of(names));
            bodies.map(|(look, place)| (look.first, *place))
        })
    }

    /// The lines between past places of the bodies with these names or numbers (none for all), with their age from 0 to 1 and
    /// the colour that the scene gives to the body, the oldest first.
    pub(crate) fn trails(&self, names: &[String]) -> impl Iterator<Item = ([Vec3; 2], f32, Option<Rgb>)> {
        let shown: Vec<bool> = self.looks.iter().map(|look| look.is_one_of(names)).collect();
        let stride = shown.iter().filter(|shown| **shown).count().div_ceil(MOST_TRAILS).max(1);
        let bodies: Vec<usize> = (0..shown.len()).filter(|body| shown[*body]).step_by(stride).collect();
        let (end, seconds) = (self.time(), self.seconds.max(f64::MIN_POSITIVE));
        let pairs = self.past.iter().zip(self.past.iter().skip(1));
        pairs.flat_map(move |(from, to)| {
            let age = ((end - to.time) / seconds).clamp(0.0, 1.0) as f32;
            let ends =
                bodies.clone().into_iter().filter_map(|body| Some((body, [*from.places.get(body)?, *to.places.get(body)?])));
            let lines = ends.filter(|(_, [from, to])| from != to);
            lines.map(move |(body, ends)| (ends, age, self.looks[body].colour))
        })
    }
}

/// What is drawn of bodies. The text beside a body is its label, or in a scene that says nothing of labels its number: the reference
/// of its first sphere, or in a scene without references the index of that sphere.
fn appearances(scene: &Scene, bodies: &[Body]) -> Vec<Appearance> {
    let has_references = scene.sphere_ids().any(|sphere| scene.reference(sphere).is_some());
    let label_of = |body: Body| {
        let objects = object_of(scene, body).into_iter().chain(spheres(scene, body).next().map(ObjectId::from));
        objects.filter_map(|object| scene.tag(object).ok().flatten()).find_map(|tag| tag.label.clone())
    };
    let has_labels = bodies.iter().any(|body| label_of(*body).is_some());
    let appearance = |body: &Body| {
        let sphere = spheres(scene, *body).next();
        let first = sphere.and_then(|sphere| Body::Sphere(sphere).index(scene).ok()).unwrap_or(usize::MAX);
        let reference = || sphere.and_then(|sphere| scene.reference(sphere)).map(|reference| reference.to_string());
        let number = if has_references { reference().unwrap_or_default() } else { first.to_string() };
        let label = match label_of(*body) {
            Some(label) => label,
            None if has_labels => String::new(),
            None => number.clone(),
        };
        let object = object_of(scene, *body);
        let colour = object.and_then(|object| colour_of(scene, object));
        let name = object.and_then(|object| name_of(scene, object)).map(str::to_owned);
        Appearance { label, radius: thickness(scene, *body), colour, first, name, number }
    };
    bodies.iter().map(appearance).collect()
}
