//! The places of the bodies over the time of a film, from which the camera is chosen.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::extent::{Extent, extents_of_static_objects};

/// Approximate number of bodies whose places are kept.
const MOST_BODIES: usize = 1000;
/// Number of bodies from which on outliers are found by quantiles.
const MANY: usize = 20;
/// Bodies farther from the majority than this times its extent are outliers.
const OUTLIER_DISTANCE: f32 = 0.6;
/// A body that comes back from an excursion is shown up to this distance from the majority, divided by its extent.
const EXCURSION: f32 = 2.0;
/// Distance from the other bodies, divided by their extent, from which on one of a few bodies is an outlier: for a body that
/// has fallen, one that was there from the start, and one that has moved to a side, which may be what the film is about.
const FALLEN: f32 = 3.0;
const FAR: f32 = 10.0;
const FLOWN: f32 = 30.0;

/// The places of the bodies in one or several states of a scene, for [`Camera::of_survey`](crate::camera::Camera::of_survey).
///
/// Bodies that fall or fly away from all others are left out, so that one of them does not make the others small.
#[derive(Clone, Debug)]
pub struct Survey {
    stride: usize,
    radii: Vec<f32>,
    /// For every body, its places in the order of the states.
    paths: Vec<Vec<Vec3>>,
    /// Points that belong to the bodies: the fixed ends of tethers.
    anchors: Option<Extent>,
    /// Direction of gravity.
    down: Vec3,
    /// Height of the lowest point of the static objects. Bodies below it fall for ever.
    lowest: f32,
}

impl Survey {
    /// Creates a survey of the present state of a scene.
    pub fn new(scene: &Scene) -> Self {
        let spheres = scene.spheres();
        let stride = spheres.len().div_ceil(MOST_BODIES).max(1);
        let lowest = extents_of_static_objects(scene).map(|object| object.min.y).reduce(f32::min);
        let mut survey = Self {
            stride,
            radii: spheres.iter().step_by(stride).map(|sphere| sphere.radius).collect(),
            paths: vec![Vec::new(); spheres.len().div_ceil(stride)],
            anchors: Extent::of(scene.tethers().iter().map(|tether| tether.point)),
            down: scene.settings.gravity_direction,
            lowest: lowest.unwrap_or(f32::NEG_INFINITY),
        };
        survey.add(scene);
        survey
    }

    /// Adds a later state of the same scene.
    pub fn add(&mut self, scene: &Scene) {
        let places = scene.spheres().iter().step_by(self.stride).map(|sphere| sphere.position);
        for (path, place) in self.paths.iter_mut().zip(places) {
            path.push(place);
        }
    }

    /// Whether the survey has several states.
    pub(crate) fn moves(&self) -> bool {
        self.paths.first().is_some_and(|path| path.len() > 1)
    }

    /// Returns the centres and radii of the bodies that a picture should show, in all states.
    pub fn balls(&self) -> Vec<(Vec3, f32)> {
        let shown = if self.paths.len() < MANY { self.without_escaped() } else { self.without_outliers() };
        let balls: Vec<_> = shown.into_iter().filter(|(place, _)| place.y >= self.lowest).collect();
        if balls.is_empty() { self.all().collect() } else { balls }
    }

    pub(crate) fn extent(&self) -> Option<Extent> {
        self.balls().into_iter().map(|(place, radius)| Extent::around(place, radius)).reduce(Extent::with)
    }

    fn all(&self) -> impl Iterator<Item = (Vec3, f32)> {
        let balls = self.paths.iter().zip(&self.radii);
        balls.flat_map(|(path, radius)| path.iter().map(move |place| (*place, *radius)))
    }

    /// All places of many bodies that are near the majority: between the 5 % and the 95 % quantile of each coordinate, or
    /// nearer to that than [`OUTLIER_DISTANCE`] times its size.
    fn without_outliers(&self) -> Vec<(Vec3, f32)> {
        let places: Vec<Vec3> = self.all().map(|(place, _)| place).filter(|place| place.y >= self.lowest).collect();
        let Some(core) = central(&places) else { return Vec::new() };
        let [near, far] = [OUTLIER_DISTANCE, EXCURSION].map(|room| core.grown(room * core.size()));
        let mut shown = Vec::new();
        for (path, radius) in self.paths.iter().zip(&self.radii) {
            let returns = path.last().is_some_and(|last| near.contains(*last));
            let room = if returns { far } else { near };
            shown.extend(path.iter().filter(|place| room.contains(**place)).map(|place| (*place, *radius)));
        }
        shown
    }

    /// All places of a few bodies, without those far from all others of bodies that never come back.
    fn without_escaped(&self) -> Vec<(Vec3, f32)> {
        let mut left: Vec<usize> = (0..self.paths.len()).collect();
        let mut escaped = Vec::new();
        while 2 * (escaped.len() + 1) <= self.paths.len() {
            let Some(at) = (0..left.len()).find(|at| self.escapes(left[*at], &left)) else { break };
            escaped.push(left.swap_remove(at));
        }
        let Some(others) = self.extent_of(&left, None) else { return Vec::new() };
        // The start of a body that flies away is shown, if it starts among the others.
        let starts = escaped.iter().filter_map(|body| Some(Extent::around(*self.paths[*body].first()?, self.radii[*body])));
        let near = starts.filter(|start| others.distance(start.min) < others.size());
        let room = near.fold(others, Extent::with).grown(0.3 * others.size());
        let path = |body: usize| self.paths[body].iter().map(move |place| (*place, self.radii[body]));
        let kept = left.iter().flat_map(|body| path(*body));
        kept.chain(escaped.iter().flat_map(|body| path(*body)).filter(|(place, _)| room.contains(*place))).collect()
    }

    /// Whether a body ends far from what the others do.
    fn escapes(&self, body: usize, left: &[usize]) -> bool {
        let ends = self.paths[body].first().zip(self.paths[body].last());
        let Some((others, (first, last))) = self.extent_of(left, Some(body)).zip(ends) else {
            return false;
        };
        let [before, after] = [first, last].map(|place| others.distance(*place));
        let moved = after > 4.0 * before + self.radii[body];
        let beside = *last - last.clamp(others.min, others.max);
        let room = match moved {
            true if beside.dot(self.down) > 0.7 * beside.length() => FALLEN,
            true => FLOWN,
            false => FAR,
        };
        after > room * others.size() || !last.is_finite()
    }

    /// Extent of the paths of some bodies and the anchors, without one of the bodies.
    fn extent_of(&self, bodies: &[usize], without: Option<usize>) -> Option<Extent> {
        let bodies = bodies.iter().filter(|body| Some(**body) != without);
        let balls = bodies.flat_map(|body| self.paths[*body].iter().map(|place| (*place, self.radii[*body])));
        let above = balls.filter(|(place, _)| place.y >= self.lowest);
        above.map(|(place, radius)| Extent::around(place, radius)).chain(self.anchors).reduce(Extent::with)
    }
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
mod tests {
    use rockfall::{Cuboid, Sphere, Tether};

    use super::*;

    /// A survey of `states` states of spheres of radius 0.5, whose places follow from body and state. The floor is at y = -1.
    fn survey(bodies: usize, states: usize, floor: bool, place: impl Fn(usize, usize) -> Vec3) -> Survey {
        let scene = |state: usize| {
            let mut scene = Scene::new();
            for body in 0..bodies {
                scene.add_sphere(Sphere::new(place(body, state), 0.5)).unwrap();
            }
            if floor {
                scene.add_box(Cuboid::between([-9.0, -2.0, -9.0], [9.0, -1.0, 9.0])).unwrap();
            }
            scene
        };
        let mut survey = Survey::new(&scene(0));
        (1..states).for_each(|state| survey.add(&scene(state)));
        survey
    }

    fn row(body: usize) -> Vec3 {
        Vec3::new(2.0 * body as f32, 0.0, 0.0)
    }

    /// The place after a free fall.
    fn fallen(state: usize) -> f32 {
        -0.5 * (state * state) as f32
    }

    #[test]
    fn the_extent_is_that_of_all_states() {
        let survey = survey(3, 5, false, |body, state| row(body) + Vec3::new(0.0, state as f32, 0.0));
        assert_eq!(survey.extent(), Some(Extent { min: Vec3::splat(-0.5), max: Vec3::new(4.5, 4.5, 0.5) }));
    }

    #[test]
    fn one_of_few_bodies_that_falls_for_ever_is_left_out() {
        let falls = |which: usize| move |body, state| row(body) + Vec3::Y * if body == which { fallen(state) } else { 0.0 };
        for bodies in [3, 10] {
            for which in 0..bodies {
                let extent = survey(bodies, 60, false, falls(which)).extent().unwrap();
                assert!(
                    extent.min.y > -20.0 && extent.max.x - extent.min.x < 2.0 * bodies as f32,
                    "{bodies} {which} {extent:?}"
                );
            }
        }
        // A pendulum beside it is enough.
        let mut scene = Scene::new();
        let bob = scene.add_sphere(Sphere::new([0.0, -2.0, 0.0], 0.5)).unwrap();
        scene.add_tether(Tether::new(bob, [0.0, 0.0, 0.0], 1.0)).unwrap();
        scene.add_sphere(Sphere::new([2.0, -4000.0, 0.0], 0.5)).unwrap();
        assert!(Survey::new(&scene).extent().unwrap().size() < 4.0);
    }

    #[test]
    fn one_of_two_bodies_that_moves_to_a_side_is_shown() {
        let place =
            |body: usize, state: usize| 2.0 * body as f32 * Vec3::Y + Vec3::X * if body == 0 { state as f32 } else { 0.0 };
        assert_eq!(survey(2, 21, false, place).extent().unwrap().max.x, 20.5);
        assert!(survey(2, 200, false, place).extent().unwrap().max.x < 2.0);
    }

    #[test]
    fn some_of_many_bodies_that_fall_for_ever_are_left_out() {
        let place = |body: usize, state| {
            Vec3::new((body % 10) as f32, (body / 10) as f32, 0.0)
                + if body % 50 == 7 { Vec3::new(3.0, 10.0 * fallen(state), 0.0) } else { Vec3::ZERO }
        };
        let extent = survey(200, 40, false, place).extent().unwrap();
        assert!(extent.size() < 45.0 && extent.min.y > -15.0, "{extent:?}");
    }

    #[test]
    fn bodies_below_the_floor_are_left_out_even_if_they_are_the_half() {
        let place = |body, state| row(body) + Vec3::Y * if body == 0 { fallen(state) } else { 0.0 };
        let extent = survey(2, 30, true, place).extent().unwrap();
        assert!(extent.min.y >= -2.5, "{extent:?}");
        // If all are below, there is nothing else to show.
        assert!(survey(2, 2, true, |body, _| row(body) - 100.0 * Vec3::Y).extent().unwrap().max.y < -90.0);
    }

    #[test]
    fn bodies_that_spread_out_or_come_from_afar_are_shown() {
        let extent = survey(4, 20, false, |body, state| (body as f32 - 1.5) * state as f32 * Vec3::X).extent().unwrap();
        assert_eq!((extent.min.x, extent.max.x), (-29.0, 29.0));
        let thrown = |body: usize, state: usize| row(body) + Vec3::X * if body == 0 { -(19.0 - state as f32) } else { 0.0 };
        assert_eq!(survey(6, 20, false, thrown).extent().unwrap().min.x, -19.5);
        assert_eq!(survey(30, 20, false, thrown).extent().unwrap().min.x, -19.5);
    }
}
