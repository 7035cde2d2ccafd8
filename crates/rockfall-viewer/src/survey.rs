//! The places of the bodies over the time of a film, from which the camera is chosen.

use rockfall::Scene;
use rockfall::glam::Vec3;

use crate::extent::{Extent, extents_of_static_objects};
use crate::groups::{Group, groups};

/// Approximate number of bodies whose places are kept.
const MOST_BODIES: usize = 1000;
/// Number of bodies from which on outliers are found by quantiles.
const MANY: usize = 20;
/// Of many bodies, those that leave the majority are outliers farther from it than this times its extent.
const OUTLIER_DISTANCE: f32 = 0.6;
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
    /// Points that belong to the bodies: the fixed ends of tethers.
    anchors: Option<Extent>,
    /// Direction of gravity.
    down: Vec3,
    /// Height of the lowest point of the static objects. Bodies that fall below it do so for ever.
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
            fixed: spheres.iter().step_by(stride).map(|sphere| sphere.fixed).collect(),
            paths: vec![Vec::new(); spheres.len().div_ceil(stride)],
            velocities: spheres.iter().step_by(stride).map(|sphere| [sphere.velocity; 2]).collect(),
            groups: groups(scene, stride),
            anchors: Extent::of(scene.tethers().iter().map(|tether| tether.point)),
            down: scene.settings.gravity_direction,
            lowest: lowest.unwrap_or(f32::NEG_INFINITY),
        };
        survey.add(scene);
        survey
    }

    /// Adds a later state of the same scene.
    pub fn add(&mut self, scene: &Scene) {
        let spheres = scene.spheres().iter().step_by(self.stride);
        for ((path, velocity), sphere) in self.paths.iter_mut().zip(&mut self.velocities).zip(spheres) {
            path.push(sphere.position);
            velocity[1] = sphere.velocity;
        }
    }

    /// Whether the survey has several states.
    pub(crate) fn moves(&self) -> bool {
        self.paths.first().is_some_and(|path| path.len() > 1)
    }

    /// Returns the centres and radii of the bodies that a picture should show, in all states.
    pub fn balls(&self) -> Vec<(Vec3, f32)> {
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

    /// The places of a body with its radius, without those from which it falls for ever.
    fn path(&self, body: usize, held: bool) -> impl Iterator<Item = (Vec3, f32)> {
        let (velocity, depth) = (self.velocities[body][1], self.lowest - self.ends(body)[1].y);
        let falls = !held && depth > 0.0 && velocity.dot(self.down) > LEAVES * depth;
        let lowest = if falls { self.lowest } else { f32::NEG_INFINITY };
        let places = self.paths[body].iter().filter(move |place| place.is_finite() && place.y >= lowest);
        places.map(move |place| (*place, self.radii[body]))
    }

    fn paths<'a>(&'a self, groups: impl IntoIterator<Item = &'a Group>) -> impl Iterator<Item = (Vec3, f32)> {
        let bodies = groups.into_iter().flat_map(|group| group.bodies.iter().map(|body| (*body, group.held)));
        bodies.flat_map(|(body, held)| self.path(body, held))
    }

    /// All places of many bodies, without those outside the majority of bodies that leave it. The majority is between the 5 % and
    /// the 95 % quantile of each coordinate, or nearer to that than [`OUTLIER_DISTANCE`] times its size.
    fn without_outliers(&self, groups: &[&Group]) -> Vec<(Vec3, f32)> {
        let places: Vec<Vec3> = self.paths(groups.iter().copied()).map(|(place, _)| place).collect();
        let Some(core) = central(&places) else { return Vec::new() };
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
        let mut shown: Vec<_> = self.paths(left).collect();
        // The start of a body that flies away is shown, if it starts among the others.
        let bodies = || escaped.iter().flat_map(|group| &group.bodies).copied();
        let starts = bodies().filter(|body| !self.is_gone(*body, 0, others, others.size()));
        let near = starts.map(|body| Extent::around(self.ends(body)[0], self.radii[body]));
        let room = near.fold(others, Extent::with).grown(0.3 * others.size());
        shown.extend(self.paths(escaped.iter().copied()).filter(|(place, _)| room.contains(*place)));
        shown
    }

    /// Whether all bodies of a group fall or fly away from the others.
    fn escapes(&self, at: usize, left: &[&Group]) -> bool {
        let Some(others) = self.extent_of(left, Some(at)) else { return false };
        let has_gone = |body: &usize| {
            let [first, last] = self.ends(*body);
            // What was beside the others at the start is a measure of the scene too, so that a film about a single ball and a
            // small fixed one shows the ball.
            let with_start = others.with(Extent::around(first, self.radii[*body])).size();
            let size = if self.is_gone(*body, 0, others, others.size()) { others.size() } else { with_start };
            !last.is_finite() || self.is_gone(*body, 1, others, size)
        };
        !left[at].held && left[at].bodies.iter().all(has_gone)
    }

    /// Whether a body, at the start (0) or at the end (1), is far from others of this size and leaves them.
    fn is_gone(&self, body: usize, end: usize, others: Extent, size: f32) -> bool {
        let place = self.ends(body)[end];
        let beside = others.to(place);
        let room = if beside.dot(self.down) > 0.7 * beside.length() { FALLEN } else { FLOWN };
        beside.length() > room * size && leaves(others, place, self.velocities[body][end])
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
mod tests {
    use rockfall::{Cuboid, Rod, Sphere, Tether};

    use super::*;

    /// A survey of `states` states of spheres of radius 0.5, whose places follow from body and state. The floor is at y = -1.
    fn survey(bodies: usize, states: usize, floor: bool, place: impl Fn(usize, usize) -> Vec3) -> Survey {
        let scene = |state: usize| {
            let mut scene = Scene::new();
            for body in 0..bodies {
                let mut sphere = Sphere::new(place(body, state), 0.5);
                sphere.velocity = (place(body, state + 1) - place(body, state)) / 0.1;
                scene.add_sphere(sphere).unwrap();
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
        let mut fallen = Sphere::new([2.0, -4000.0, 0.0], 0.5);
        fallen.velocity.y = -280.0;
        scene.add_sphere(fallen).unwrap();
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

    /// A pendulum with a rod of length 1, in `states` states of its swing, without or with many balls around its pivot.
    fn pendulum(states: usize, [pivot, ball]: [f32; 2], balls: usize) -> Survey {
        let scene = |state: usize| {
            let mut scene = Scene::new();
            let (sin, cos) = (0.2 * state as f32).sin_cos();
            let mut fixed = Sphere::new([0.0, 2.0, 0.0], pivot);
            fixed.fixed = true;
            let mut bob = Sphere::new([sin, 2.0 - cos, 0.0], ball);
            bob.velocity = Vec3::new(cos, sin, 0.0);
            let [fixed, bob] = [fixed, bob].map(|sphere| scene.add_sphere(sphere).unwrap());
            scene.add_rod(Rod::new(fixed, bob, 0.01)).unwrap();
            for k in 0..balls {
                scene.add_sphere(Sphere::new([0.01 * k as f32, 2.2, 0.0], 0.001)).unwrap();
            }
            scene
        };
        let mut survey = Survey::new(&scene(0));
        (1..states).for_each(|state| survey.add(&scene(state)));
        survey
    }

    #[test]
    fn a_body_that_is_bonded_to_one_in_view_is_shown() {
        for radii in [[0.02, 0.05], [0.02, 0.1], [0.04, 0.1], [0.04, 0.2], [0.05, 0.05]] {
            for (states, balls) in [(1, 0), (8, 0), (1, 30), (8, 30)] {
                let extent = pendulum(states, radii, balls).extent().unwrap();
                assert!((extent.min.y - 1.0 + radii[1]).abs() < 1e-5, "{radii:?} {states} {balls}: {extent:?}");
            }
        }
        // A pair that falls for ever is left out, even if it began above a fixed ball.
        let mut scene = Scene::new();
        let pair = [0.0, 1.0].map(|x| {
            let mut sphere = Sphere::new([x, -500.0, 0.0], 0.1);
            sphere.velocity.y = -100.0;
            scene.add_sphere(sphere).unwrap()
        });
        scene.add_rod(Rod::new(pair[0], pair[1], 0.01)).unwrap();
        for k in 0..3 {
            scene.add_sphere(Sphere::new([k as f32, 0.0, 0.0], 0.1)).unwrap();
        }
        assert!(Survey::new(&scene).extent().unwrap().min.y > -1.0);
    }

    #[test]
    fn a_body_that_does_not_move_away_is_shown() {
        for bodies in [2, 10, 40] {
            let place = |body, _| if body == 0 { Vec3::new(0.0, -4000.0, 0.0) } else { row(body) };
            for states in [1, 5] {
                assert_eq!(survey(bodies, states, false, place).extent().unwrap().min.y, -4000.5, "{bodies} {states}");
            }
            // It hangs below the lowest static object.
            assert_eq!(survey(bodies, 3, true, place).extent().unwrap().min.y, -4000.5);
        }
    }

    #[test]
    fn a_ball_that_falls_beside_a_small_fixed_one_is_shown_while_it_is_near() {
        let scene = |time: f32| {
            let mut scene = Scene::new();
            let mut small = Sphere::new([0.0, 0.0, 0.0], 0.01);
            small.fixed = true;
            scene.add_sphere(small).unwrap();
            let mut ball = Sphere::new([0.5, 1.0 - 5.0 * time * time, 0.0], 0.05);
            ball.velocity.y = -10.0 * time;
            scene.add_sphere(ball).unwrap();
            scene
        };
        let lowest = |end: f32| {
            let mut survey = Survey::new(&scene(0.0));
            (1..=20).for_each(|k| survey.add(&scene(end * k as f32 / 20.0)));
            survey.extent().unwrap().min.y
        };
        assert!((lowest(0.7) + 1.5).abs() < 0.01);
        assert!(lowest(10.0) > -1.0);
    }

    #[test]
    fn a_huge_fixed_sphere_is_a_ground() {
        let mut scene = Scene::new();
        for k in 0..3 {
            scene.add_sphere(Sphere::new([k as f32, 0.5, 0.0], 0.5)).unwrap();
        }
        let mut ground = Sphere::new([0.0, -100.0, 0.0], 100.0);
        ground.fixed = true;
        scene.add_sphere(ground).unwrap();
        assert_eq!(
            Survey::new(&scene).extent(),
            Some(Extent { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(2.5, 1.0, 0.5) })
        );
    }
}
