//! Keeps the bodies in the picture until the user moves the camera.

use rockfall::Scene;
use rockfall::glam::Vec3;

use super::Viewer;
use crate::camera::Camera;
use crate::survey::Survey;

/// Wall time between two looks at the bodies, in s.
const INTERVAL: f64 = 0.25;
/// Wall time in which the camera covers 63 % of its way, in s.
const EASE: f64 = 0.4;
/// Part of the way that is left when the camera arrives.
const ARRIVED: f32 = 0.01;
/// Part of the picture, from its middle to its edges, in which the centres of the bodies have to be.
const INSIDE: f32 = 0.92;
/// Number of spheres above which the camera stays, because looking at all of them takes too long.
const MOST_SPHERES: usize = 200_000;
/// Number of states after which the camera stays.
const MOST_STATES: usize = 200;

/// What the bodies did that was outside of the picture, and where the camera moves to show it.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    /// The initial state, and the states in which a body was outside.
    survey: Survey,
    states: usize,
    /// What the survey is of: the number of the simulation and of its objects.
    versions: [u64; 2],
    /// Number of steps and time of the last look at the bodies, in s.
    looked: (u64, f64),
    /// Time of the last movement of the camera, in s.
    moved: f64,
    goal: Option<Camera>,
}

impl Viewer {
    /// Moves the camera so that all that a film would show is in the picture, unless the user has moved it or it follows a body.
    pub fn keep_in_view(&mut self) {
        let is_free = self.camera != self.framed || self.is_following() || self.session.played().is_some();
        if is_free || self.session.device_failed() {
            self.kept = None;
            return;
        }
        let (now, steps) = (self.session.now(), self.session.simulation_ref().report().steps);
        let versions = [self.session.simulation_version(), self.session.objects_version()];
        let due = match &self.kept {
            Some(kept) if kept.versions == versions => kept.looked.0 != steps && now - kept.looked.1 >= INTERVAL,
            _ => self.session.simulation_ref().scene().counts().spheres <= MOST_SPHERES,
        };
        if due {
            self.look_at_bodies(versions, (steps, now));
        }
        self.ease(now);
    }

    fn look_at_bodies(&mut self, versions: [u64; 2], looked: (u64, f64)) {
        let (aspect, direction, camera) = (self.aspect(), self.direction, self.framed);
        let Ok(scene) = self.session.simulation().sync() else { return };
        let Some(mut kept) = self.kept.take().filter(|kept| kept.versions == versions) else {
            self.kept = Some(Kept {
                survey: Survey::with_up(scene, camera.up),
                states: 1,
                versions,
                looked,
                moved: looked.1,
                goal: None,
            });
            return;
        };
        kept.looked = looked;
        let target = kept.goal.unwrap_or(camera);
        if kept.states < MOST_STATES && !shows(&target, scene, aspect) {
            kept.survey.add(scene);
            kept.states += 1;
            let shown = Camera::of_survey(&kept.survey, scene, aspect, direction, false);
            // It only moves back.
            let away = shown.eye - shown.target;
            let distance = away.length().max(camera.eye.distance(camera.target));
            kept.goal = Some(Camera { eye: shown.target + distance * away.normalize_or(Vec3::Z), ..shown });
        }
        self.kept = Some(kept);
    }

    /// Moves the camera a part of the way to its goal.
    fn ease(&mut self, now: f64) {
        let Some(kept) = &mut self.kept else { return };
        let elapsed = now - std::mem::replace(&mut kept.moved, now);
        let Some(goal) = kept.goal else { return };
        let part = (1.0 - (-elapsed / EASE).exp()) as f32;
        let [eye, target] =
            [(self.camera.eye, goal.eye), (self.camera.target, goal.target)].map(|(from, to)| from.lerp(to, part));
        self.camera = Camera { eye, target, ..goal };
        if eye.distance(goal.eye) < ARRIVED * goal.eye.distance(goal.target) {
            self.camera = goal;
            kept.goal = None;
        }
        self.framed = self.camera;
        self.limits = None;
    }

    /// Whether the camera moves by itself.
    pub(super) fn is_easing(&self) -> bool {
        self.kept.as_ref().is_some_and(|kept| kept.goal.is_some())
    }
}

/// Whether the bodies that a picture of a scene should show are in the picture of a camera.
fn shows(camera: &Camera, scene: &Scene, aspect: f32) -> bool {
    let projection = camera.view_projection(aspect);
    let is_in_front = |place: Vec3| (place - camera.eye).dot(camera.axes().forward) > camera.near();
    Survey::with_up(scene, camera.up).balls().into_iter().all(|(place, _)| {
        let ndc = projection.project_point3(place);
        is_in_front(place) && ndc.x.abs() < INSIDE && ndc.y.abs() < INSIDE
    })
}
