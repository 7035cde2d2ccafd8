//! The places of the bodies over the time of a film, from which the camera is chosen.

use rockfall::glam::Vec3;
use rockfall::{Body, Scene, SphereId};

use crate::extent::{Extent, extents_of_static_objects};
use crate::groups::{Group, groups};
use crate::joints::fixed_ends;
use crate::up::Up;

/// Approximate number of bodies whose places are kept.
const MOST_BODIES: usize = 1000;
/// Number of spheres that are kept of a state in which they come and go.
const MOST_PASSING: usize = 200;
/// Number of bodies from which on outliers are found by quantiles.
const MANY: usize = 20;
/// Of many bodies, those that leave the majority are outliers farther from it than this times its extent.
const OUTLIER_DISTANCE: f32 = 0.6;
/// Of many bodies, none is an outlier if all of them need less room than this times the extent of the majority.
const ROOM_FOR_ALL: f32 = 2.5;
/// A picture also shows where bodies were at the start of its run, if that needs less room than this times their present extent.
const ROOM_FOR_START: f32 = 4.0;
/// A body that falls below all static objects is shown for this part of the extent of the places above.
const FALL_SHOWN: f32 = 0.3;
/// A body that comes back from an excursion is shown up to this distance from the majority, divided by its extent.
const EXCURSION: f32 = 2.0;
/// One of a few bodies that leaves the others is an outlier if it is farther from them than their extent times this: a body that
/// has fallen, and one that has moved to a side, which may be what the film is about.
const FALLEN: f32 = 3.0;
const FLOWN: f32 = 30.0;
/// A body leaves others if its distance from them grows by at least this part in a second. A body that has moved away for less
/// than 100 s does so, a body at rest does not.
const LEAVES: f32 = 0.01;
/// An unbonded fixed sphere whose radius is more than this times the extent of all other bodies is a ground.
const GROUND_RADIUS: f32 = 5.0;

/// The places of the bodies in one or several states of a scene, for [`Camera::of_survey`](crate::camera::Camera::of_survey).
///
/// Bodies that fall or fly away from all others are left out, so that one of them does not make the others small. Nothing else
/// is left out: not a body that is bonded to one in view, and not a body that does not move away.
#[derive(Clone, Debug)]
pub struct Survey {
    stride: usize,
    radii: Vec<f32>,
    fixed: Vec<bool>,
    /// For every body, its places in the order of the states.
    paths: Vec<Vec<Vec3>>,
    /// For every body, its velocities in the first and in the last state.
    velocities: Vec<[Vec3; 2]>,
    /// Bodies that are in view together, or not at all.
    groups: Vec<Group>,
    /// Points that belong to the bodies: the fixed ends of tethers and distance joints.
    anchors: Option<Extent>,
    /// Direction of gravity.
    down: Vec3,
    /// The axis upwards in pictures.
    up: Up,
    /// Height of the lowest point of the static objects. Bodies that fall below it do so for ever.
    lowest: f32,
    /// Extent of all places above that.
    above: Option<Extent>,
    /// The inlets and all spheres, in a scene whose spheres come and go. The bodies are then not the same in all states.
    coming: Option<Extent>,
    /// Some of these spheres in all states.
    passing: Vec<(Vec3, f32)>,
    /// Whether it is that of a single picture, also if it has past places.
    is_single: bool,
}

impl Survey {
    /// Creates a survey of the present state of a scene. In its pictures, up is opposite to gravity, as in [`Up::of`].
    pub fn new(scene: &Scene) -> Self {
        Self::with_up(scene, Up::of(scene))
    }

    /// Creates a survey of the present state of a scene for pictures with this axis upwards.
    pub fn with_up(scene: &Scene, up: Up) -> Self {
        let spheres = scene.spheres();
        let stride = spheres.len().div_ceil(MOST_BODIES).max(1);
        let lowest = extents_of_static_objects(scene).map(|object| up.bottom(object)).reduce(f32::min);
        let mut survey = Self {
            stride,
            radii: spheres.iter().step_by(stride).map(|sphere| sphere.radius).collect(),
            fixed: spheres.iter().step_by(stride).map(|sphere| sphere.fixed).collect(),
            paths: vec![Vec::new(); spheres.len().div_ceil(stride)],
            velocities: spheres.iter().step_by(stride).map(|sphere| [sphere.velocity; 2]).collect(),
            groups: groups(scene, stride),
            anchors: Extent::of(scene.tethers().iter().map(|tether| tether.point).chain(fixed_ends(scene))),
            down: scene.settings.gravity_direction,
            up,
            lowest: lowest.unwrap_or(f32::NEG_INFINITY),
            above: None,
            coming: Extent::of(scene.inlets().iter().flat_map(|inlet| inlet.corners).map(|corner| corner.as_vec3())),
            passing: Vec::new(),
            is_single: false,
        };
        survey.add(scene);
        survey
    }

    /// Adds a later state of the same scene.
    pub fn add(&mut self, scene: &Scene) {
        if !(scene.inlets().is_empty() && scene.outlets().is_empty()) {
            let there = scene.spheres().iter().filter(|sphere| self.is_above(sphere.position) && sphere.position.is_finite());
            let balls: Vec<_> = there.map(|sphere| (sphere.position, sphere.radius)).collect();
            let extents = balls.iter().map(|(place, radius)| Extent::around(*place, *radius));
            self.coming = extents.chain(self.coming).reduce(Extent::with);
            let stride = balls.len().div_ceil(MOST_PASSING).max(1);
            self.passing.extend(balls.into_iter().step_by(stride));
        }
        let spheres = scene.spheres().iter().step_by(self.stride);
        for ((path, velocity), sphere) in self.paths.iter_mut().zip(&mut self.velocities).zip(spheres) {
            let position = scene.in_box(sphere.position);
            path.push(position);
            velocity[1] = sphere.velocity;
            if self.up.height(position) >= self.lowest && position.is_finite() && !sphere.fixed {
                let place = Extent::around(position, sphere.radius);
                self.above = Some(self.above.map_or(place, |above| above.with(place)));
            }
        }
    }

    /// Returns the survey of a picture and of the start of its run, if that needs not much more room than the picture alone. So
    /// a machine is in view from where its bodies come.
    pub fn from_start(self, start: Self, scene: &Scene) -> Self {
        let mut both = start;
        both.add(scene);
        both.is_single = true;
        let room = |survey: &Self| survey.extent().map_or(0.0, Extent::size);
        if room(&both) < ROOM_FOR_START * room(&self) { both } else { self }
    }

    /// Adds the places of bodies in past states, the oldest first, each with the index of the first sphere of the body: those of the
    /// trails in a picture of the present state.
    pub fn add_trails<Places: Iterator<Item = (usize, Vec3)>>(&mut self, past: impl Iterator<Item = Places>) {
        for places in past {
            self.is_single = true;
            for (sphere, place) in places.filter(|(sphere, _)| sphere % self.stride == 0) {
                // The last place stays the present one.
                if let Some(path) = self.paths.get_mut(sphere / self.stride) {
                    path.insert(path.len() - 1, place);
                }
            }
        }
    }

    /// Returns the survey seen from a camera that moves with the middle of some spheres, but not along the unit vector `ignored`: their
    /// places relative to that middle. Other bodies are where they are in the first state.
    pub(crate) fn moving_with(&self, scene: &Scene, spheres: &[SphereId], ignored: Vec3) -> Self {
        let indices = spheres.iter().filter_map(|id| Body::Sphere(*id).index(scene).ok());
        let bodies: Vec<usize> = indices.filter(|index| index % self.stride == 0).map(|index| index / self.stride).collect();
        let mut moving = self.clone();
        for (path, velocity) in moving.paths.iter_mut().zip(&mut moving.velocities) {
            let first = path[0];
            path.fill(first);
            velocity[1] = velocity[0];
        }
        let middle =
            |state: usize| bodies.iter().map(|body| self.paths[*body][state]).sum::<Vec3>() / bodies.len().max(1) as f32;
        for state in 0..self.paths.first().map_or(0, Vec::len) {
            let moved = middle(state) - middle(0);
            let moved = moved - moved.dot(ignored) * ignored;
            for body in &bodies {
                moving.paths[*body][state] = self.paths[*body][state] - moved;
            }
        }
        moving
    }

    /// The axis upwards in pictures.
    pub(crate) fn up(&self) -> Up {
        self.up
    }

    /// Whether a place is not below all static objects.
    fn is_above(&self, place: Vec3) -> bool {
        self.up.height(place) >= self.lowest
    }

    /// Whether the survey has several states of a film.
    pub(crate) fn moves(&self) -> bool {
        !self.is_single && self.paths.first().is_some_and(|path| path.len() > 1)
    }

    /// Returns the centres and radii of the bodies that a picture should show, in all states.
    pub fn balls(&self) -> Vec<(Vec3, f32)> {
        if let Some(extent) = self.coming {
            return extent.corners().map(|corner| (corner, 0.0)).chain(self.passing.iter().copied()).collect();
        }
        let grounds = self.grounds();
        let groups: Vec<&Group> =
            self.groups.iter().filter(|group| !matches!(group.bodies[..], [one] if grounds[one])).collect();
        let balls = if self.paths.len() < MANY { self.without_escaped(&groups) } else { self.without_outliers(&groups) };
        if balls.is_empty() { self.all().collect() } else { balls }
    }

    pub(crate) fn extent(&self) -> Option<Extent> {
        self.balls().into_iter().map(|(place, radius)| Extent::around(place, radius)).reduce(Extent::with)
    }

    fn all(&self) -> impl Iterator<Item = (Vec3, f32)> {
        let balls = self.paths.iter().zip(&self.radii);
        balls.flat_map(|(path, radius)| path.iter().map(move |place| (*place, *radius)))
    }

    /// Whether each body is a fixed sphere that is so large that it is a ground for the others.
    fn grounds(&self) -> Vec<bool> {
        let movers = (0..self.paths.len()).filter(|body| !self.fixed[*body]);
        let extent = movers.flat_map(|body| self.paths[body].iter().map(move |place| Extent::around(*place, self.radii[body])));
        let least = extent.reduce(Extent::with).map_or(f32::INFINITY, |extent| GROUND_RADIUS * extent.size());
        self.fixed.iter().zip(&self.radii).map(|(fixed, radius)| *fixed && *radius > least).collect()
    }

    /// The first and the last place of a body.
    fn ends(&self, body: usize) -> [Vec3; 2] {
        let path = &self.paths[body];
        [path[0], path[path.len() - 1]]
    }

    /// Whether a body falls for ever, below all static objects.
    fn falls(&self, body: usize, held: bool) -> bool {
        let (velocity, depth) = (self.velocities[body][1], self.lowest - self.up.height(self.ends(body)[1]));
        !held && depth > 0.0 && velocity.dot(self.down) > LEAVES * depth
    }

    /// The places of a body with its radius, without those far below all static objects from which it falls for ever.
    fn path(&self, body: usize, held: bool) -> impl Iterator<Item = (Vec3, f32)> {
        // One of many bodies is not worth the room.
        let shown = if self.paths.len() < MANY { FALL_SHOWN * self.above.map_or(0.0, Extent::size) } else { 0.0 };
        let lowest = if self.falls(body, held) { self.lowest - shown } else { f32::NEG_INFINITY };
        let places = self.paths[body].iter().filter(move |place| place.is_finite() && self.up.height(**place) >= lowest);
        places.map(move |place| (*place, self.radii[body]))
    }

    fn paths<'a>(&'a self, groups: impl IntoIterator<Item = &'a Group>) -> impl Iterator<Item = (Vec3, f32)> {
        let bodies = groups.into_iter().flat_map(|group| group.bodies.iter().map(|body| (*body, group.held)));
        bodies.flat_map(|(body, held)| self.path(body, held))
    }

    /// All places of many bodies, without those outside the majority of bodies that leave it, if all need far more room. The
    /// majority is between the 5 % and the 95 % quantile of each coordinate, or nearer to that than [`OUTLIER_DISTANCE`] times its size.
    fn without_outliers(&self, groups: &[&Group]) -> Vec<(Vec3, f32)> {
        let places: Vec<Vec3> = self.paths(groups.iter().copied()).map(|(place, _)| place).collect();
        let Some(core) = central(&places) else { return Vec::new() };
        let falls = |group: &&Group| group.bodies.iter().any(|body| self.falls(*body, group.held));
        let (falling, staying): (Vec<&Group>, Vec<&Group>) = groups.iter().copied().partition(falls);
        let mut all: Vec<(Vec3, f32)> = self.paths(staying).collect();
        let extent = Extent::of(all.iter().map(|(place, _)| *place));
        if let Some(extent) = extent.filter(|extent| extent.size() < ROOM_FOR_ALL * core.size()) {
            all.extend(self.paths(falling).filter(|(place, _)| extent.contains(*place)));
            return all;
        }
        let [near, far] = [OUTLIER_DISTANCE, EXCURSION].map(|room| core.grown(room * core.size()));
        let mut shown = Vec::new();
        for group in groups {
            let stays = |body: &usize| near.contains(self.ends(*body)[1]);
            let bonded = group.held || group.bodies.len() > 1 && group.bodies.iter().any(stays);
            for body in &group.bodies {
                let path = self.path(*body, group.held);
                let room = match bonded {
                    true => None,
                    false if stays(body) => Some(far),
                    false => leaves(core, self.ends(*body)[1], self.velocities[*body][1]).then_some(near),
                };
                shown.extend(path.filter(|(place, _)| room.is_none_or(|room| room.contains(*place))));
            }
        }
        shown
    }

    /// All places of a few bodies, without those far from all others of bodies that fall or fly away.
    fn without_escaped(&self, groups: &[&Group]) -> Vec<(Vec3, f32)> {
        let mut left = groups.to_vec();
        let mut escaped: Vec<&Group> = Vec::new();
        let mut count = 0;
        loop {
            // At most a half of the bodies.
            let may = |at: &usize| 2 * (count + left[*at].bodies.len()) <= self.paths.len();
            let Some(at) = (0..left.len()).find(|at| may(at) && self.escapes(*at, &left)) else { break };
            count += left[at].bodies.len();
            escaped.push(left.swap_remove(at));
        }
        let Some(others) = self.extent_of(&left, None) else { return Vec::new() };
        let mut shown: Vec<_> = self.paths(left.iter().copied()).collect();
        // The start of a body that flies away is shown, if it starts among the others.
        let bodies = || escaped.iter().flat_map(|group| &group.bodies).copied();
        let drift = self.velocity_of(&left, None, 0);
        let starts = bodies().filter(|body| !self.is_gone(*body, 0, others, others.size(), drift));
        let near = starts.map(|body| Extent::around(self.ends(body)[0], self.radii[body]));
        let room = near.fold(others, Extent::with).grown(0.3 * others.size());
        shown.extend(self.paths(escaped.iter().copied()).filter(|(place, _)| room.contains(*place)));
        shown
    }

    /// Whether all bodies of a group fall or fly away from the others.
    fn escapes(&self, at: usize, left: &[&Group]) -> bool {
        let Some(others) = self.extent_of(left, Some(at)) else { return false };
        let [start, end] = [0, 1].map(|end| self.velocity_of(left, Some(at), end));
        let has_gone = |body: &usize| {
            let [first, last] = self.ends(*body);
            // What was beside the others at the start is a measure of the scene too, so that a film about a single ball and a
            // small fixed one shows the ball.
            let with_start = others.with(Extent::around(first, self.radii[*body])).size();
            let size = if self.is_gone(*body, 0, others, others.size(), start) { others.size() } else { with_start };
            !last.is_finite() || self.is_gone(*body, 1, others, size, end)
        };
        !left[at].held && left[at].bodies.iter().all(has_gone)
    }

    /// Whether a body, at the start (0) or at the end (1), is far from others of this size and mean velocity, and leaves them.
    fn is_gone(&self, body: usize, end: usize, others: Extent, size: f32, drift: Vec3) -> bool {
        let place = self.ends(body)[end];
        let beside = others.to(place);
        // Above a static object, a body may still fall onto it.
        let has_fallen = beside.dot(self.down) > 0.7 * beside.length() && !(self.is_above(place) && self.lowest.is_finite());
        let room = if has_fallen { FALLEN } else { FLOWN };
        beside.length() > room * size && leaves(others, place, self.velocities[body][end] - drift)
    }

    /// The mean velocity of the moving bodies of some groups at the start (0) or at the end (1), without one of the groups.
    fn velocity_of(&self, groups: &[&Group], without: Option<usize>, end: usize) -> Vec3 {
        let groups = groups.iter().enumerate().filter(|(at, _)| Some(*at) != without).map(|(_, group)| *group);
        let bodies = groups.flat_map(|group| &group.bodies).filter(|body| !self.fixed[**body]);
        let (sum, count) =
            bodies.fold((Vec3::ZERO, 0_u16), |(sum, count), body| (sum + self.velocities[*body][end], count + 1));
        sum / f32::from(count.max(1))
    }

    /// Extent of the paths of some groups and the anchors, without one of the groups.
    fn extent_of(&self, groups: &[&Group], without: Option<usize>) -> Option<Extent> {
        let groups = groups.iter().enumerate().filter(|(at, _)| Some(*at) != without).map(|(_, group)| *group);
        self.paths(groups).map(|(place, radius)| Extent::around(place, radius)).chain(self.anchors).reduce(Extent::with)
    }
}

/// Whether a body moves away from others.
fn leaves(others: Extent, place: Vec3, velocity: Vec3) -> bool {
    let beside = others.to(place);
    velocity.dot(beside) > LEAVES * beside.length_squared()
}

/// The box between the 5 % and the 95 % quantile of each coordinate.
fn central(places: &[Vec3]) -> Option<Extent> {
    let few = places.len() / 20;
    let mut core = Extent::of(places.iter().copied())?;
    for axis in 0..3 {
        let mut numbers: Vec<f32> = places.iter().map(|place| place[axis]).collect();
        core.min[axis] = *numbers.select_nth_unstable_by(few, f32::total_cmp).1;
        core.max[axis] = *numbers.select_nth_unstable_by(places.len() - 1 - few, f32::total_cmp).1;
    }
    Some(core)
}

#[cfg(test)]
mod tests;
