//! The camera of a picture or a film.

use rockfall::glam::Vec3;
use rockfall::{Result, Scene};

use crate::camera::{Camera, Direction};
use crate::film::Moment;
use crate::subject::Subject;
use crate::survey::Survey;
use crate::whole::ball;

/// Distance of a camera that follows a body, in radii of the body, and divided by the distance that would show everything.
const FOLLOW_RADII: f32 = 14.0;
const FOLLOW_PART: f32 = 0.45;

/// What is known of the camera of a film. The rest is chosen so that the bodies are in view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// Direction from which the camera looks, unless its position is given.
    pub from: Direction,
    /// Position of the camera, in units.
    pub camera: Option<Vec3>,
    /// Point in the middle of the picture, in units.
    pub look_at: Option<Vec3>,
    /// What the camera moves with. A body stays in the middle of the picture, instead of `look_at`.
    pub follow: Option<Subject>,
    /// Angular speed around the target, in rad per second of film.
    pub orbit: f32,
    /// Part of the height of the picture that stays free at its upper edge for text, if the whole camera is chosen.
    pub room_above: f32,
}

/// A camera that may follow a body and orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    camera: Camera,
    orbit: f32,
    /// Where what the camera follows is at the start.
    start: Option<Vec3>,
    /// Unit vector along which the camera does not follow, or 0.
    ignored: Vec3,
}

impl Shot {
    /// Chooses the camera for a film that starts in the state of `scene`; `aspect` is the width of the picture divided by its
    /// height. What `view` does not set is chosen so that the bodies of the survey are in view. `None` if the camera is at the
    /// point that it looks at.
    ///
    /// # Errors
    /// [`rockfall::Error::StaleHandle`] when the followed body is not in the scene.
    pub fn new(view: &View, survey: &Survey, scene: &Scene, aspect: f32) -> Result<Option<Self>> {
        let all_around = view.orbit != 0.0;
        let framing_of = |survey: &Survey| Camera::of_survey(survey, scene, aspect, view.from, all_around);
        let ignored = view.follow.as_ref().map_or(Vec3::ZERO, |subject| subject.ignored(scene));
        let mut framing = match &view.follow {
            // What creatures do later, they do elsewhere, where the camera follows them.
            Some(Subject::Creatures(ends)) => framing_of(&survey.moving_with(scene, ends, ignored)),
            _ => framing_of(survey),
        };
        if view.camera.is_none() && view.look_at.is_none() && !matches!(view.follow, Some(Subject::Body(_))) {
            framing = framing.with_room_above(view.room_above);
        }
        let mut eye = framing.eye;
        let mut target = view.look_at.unwrap_or(framing.target);
        let start = view.follow.as_ref().map(|subject| subject.place(scene)).transpose()?;
        if let Some(Subject::Body(body)) = view.follow {
            let radius = ball(scene, body).map_or(0.0, |(_, radius)| radius);
            let whole = framing.eye - framing.target;
            let distance = (FOLLOW_PART * whole.length()).max(FOLLOW_RADII * radius);
            target = start.unwrap_or(target);
            eye = target + distance * whole.normalize_or(Vec3::Z);
        }
        let eye = view.camera.unwrap_or(eye);
        let camera = Camera { eye, target, ..framing };
        Ok((eye != target).then_some(Self { camera, orbit: view.orbit, start, ignored }))
    }

    /// Returns the camera at the start of the film.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// Returns the camera `seconds` after the start of the film, with the place of what it follows.
    pub fn at(&self, seconds: f64, followed: Option<Vec3>) -> Camera {
        let camera = self.camera.orbited((f64::from(self.orbit) * seconds) as f32);
        let moved = self.start.zip(followed).map_or(Vec3::ZERO, |(start, place)| place - start);
        camera.looking_at(camera.target + moved - moved.dot(self.ignored) * self.ignored)
    }
}

/// Finds where a followed body is at moments between two states.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follower {
    /// The step of the state before the moment, and the place of the body in it.
    from: Option<(u64, Vec3)>,
}

impl Follower {
    /// Shows a moment and returns the place of the followed body at it. `show` shows a moment and returns the place of the body
    /// in the state that the simulation then has; it is called up to twice, with moments that do not go back.
    ///
    /// # Errors
    /// Those of `show`.
    pub fn show(&mut self, moment: Moment, mut show: impl FnMut(Moment) -> Result<Vec3>) -> Result<Vec3> {
        let before = match self.from {
            Some((step, place)) if step == moment.step => place,
            _ => show(Moment { blend: 0.0, ..moment })?,
        };
        self.from = Some((moment.step, before));
        if moment.blend == 0.0 {
            return Ok(before);
        }
        Ok(before.lerp(show(moment)?, moment.blend))
    }
}

#[cfg(test)]
mod tests {
    use rockfall::{Body, Muscle, Sphere, SphereId, Spring};

    use super::*;

    fn scene() -> (Scene, SphereId) {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([9.0, 0.0, 0.0], 0.5)).unwrap();
        let followed = scene.add_sphere(Sphere::new([1.0, 2.0, 3.0], 0.5)).unwrap();
        (scene, followed)
    }

    #[test]
    fn a_shot_takes_what_is_given_and_follows_a_body() {
        let (scene, followed) = scene();
        let survey = Survey::new(&scene);
        let shot = |view: View| Shot::new(&view, &survey, &scene, 1.5).unwrap();
        let given = shot(View { camera: Some(Vec3::X), look_at: Some(Vec3::Y), ..View::default() }).unwrap();
        assert_eq!((given.camera().eye, given.camera().target), (Vec3::X, Vec3::Y));
        assert_eq!(shot(View { camera: Some(Vec3::X), look_at: Some(Vec3::X), ..View::default() }), None);
        let follow = shot(View { follow: Some(Subject::Body(Body::Sphere(followed))), ..View::default() }).unwrap();
        assert_eq!(follow.camera().target, Vec3::new(1.0, 2.0, 3.0));
        let framing = Camera::of_survey(&survey, &scene, 1.5, Direction::Oblique, false);
        let part = FOLLOW_PART * framing.eye.distance(framing.target);
        let distance = follow.camera().eye.distance(follow.camera().target);
        assert!((distance - part.max(FOLLOW_RADII * 0.5)).abs() < 1e-3, "{distance} {part}");
        assert_eq!(follow.at(1.0, Some(Vec3::ZERO)).target, Vec3::ZERO);
        let room = shot(View { room_above: 0.1, ..View::default() }).unwrap().camera();
        assert_eq!(room, framing.with_room_above(0.1));
        let orbit = shot(View { orbit: std::f32::consts::PI, ..View::default() }).unwrap();
        let [start, end] = [0.0, 1.0].map(|seconds| orbit.at(seconds, None));
        let [one, other] = [start, end].map(|camera| camera.eye - camera.target);
        assert!((one.x + other.x).abs() + (one.z + other.z).abs() < 1e-3 * one.length(), "{one} {other}");
    }

    #[test]
    fn creatures_are_followed_along_the_ground() {
        let (mut scene, followed) = scene();
        let other = scene.add_sphere(Sphere::new([1.0, 4.0, 3.0], 0.5)).unwrap();
        scene.add_spring(Spring::new(followed, other, 1.0, 1.0).muscle(Muscle::new(0.1, 1.0, 0.0))).unwrap();
        let survey = Survey::new(&scene);
        let view = View { follow: Subject::creatures(&scene), ..View::default() };
        let shot = Shot::new(&view, &survey, &scene, 1.5).unwrap().unwrap();
        assert_eq!(shot.camera(), Camera::of_survey(&survey, &scene, 1.5, Direction::Oblique, false));
        let later = shot.at(1.0, Some(Vec3::new(6.0, 5.0, 3.0)));
        assert!((later.target - shot.camera().target).distance(Vec3::new(5.0, 0.0, 0.0)) < 1e-5, "{later:?}");
        assert!((later.eye - shot.camera().eye).distance(Vec3::new(5.0, 0.0, 0.0)) < 1e-5, "{later:?}");
    }

    /// A creature that grows while it walks does not leave the picture.
    #[test]
    fn the_camera_of_creatures_shows_what_they_do_in_all_states() {
        let creature = |middle: f32, half: f32| {
            let mut scene = Scene::new();
            let ends = [-half, half].map(|x| scene.add_sphere(Sphere::new([middle + x, 1.0, 0.0], 0.2)).unwrap());
            scene.add_spring(Spring::new(ends[0], ends[1], 1.0, 1.0).muscle(Muscle::new(0.1, 1.0, 0.0))).unwrap();
            scene
        };
        let distance = |half: f32| {
            let scene = creature(0.0, 1.0);
            let mut survey = Survey::new(&scene);
            survey.add(&creature(50.0, half));
            let view = View { follow: Subject::creatures(&scene), ..View::default() };
            let camera = Shot::new(&view, &survey, &scene, 1.5).unwrap().unwrap().camera();
            camera.eye.distance(camera.target)
        };
        let [same, twice] = [1.0, 2.0].map(distance);
        assert!((1.5..2.5).contains(&(twice / same)) && same < 10.0, "{same} {twice}");
    }

    #[test]
    fn a_followed_body_is_between_two_states() {
        let mut follower = Follower::default();
        let mut calls = 0;
        let mut place = |moment: Moment| {
            calls += 1;
            Ok(Vec3::X * (moment.step as f32 + f32::from(u8::from(moment.blend > 0.0))))
        };
        for (step, blend, expected) in [(0, 0.0, 0.0), (0, 0.25, 0.25), (0, 0.5, 0.5), (3, 0.5, 3.5)] {
            let found = follower.show(Moment { step, blend }, &mut place).unwrap();
            assert_eq!(found.x, expected);
        }
        assert_eq!(calls, 5, "a state that is known is not shown again");
    }
}
