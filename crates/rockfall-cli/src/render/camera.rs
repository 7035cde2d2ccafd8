//! The camera of a picture or a film.

use rockfall::glam::Vec3;
use rockfall::{Scene, Simulation, SphereId};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::survey::Survey;

use super::Arguments;
use crate::failure::Failure;

/// Distance of a camera that follows a body, in radii of the body, and divided by the distance that would show everything.
const FOLLOW_RADII: f32 = 14.0;
const FOLLOW_PART: f32 = 0.45;

/// A camera that may follow a body and orbit.
pub(super) struct Shot {
    /// The camera at the start.
    camera: Camera,
    follow: Option<SphereId>,
    /// Angular speed around the target, in rad per second of film.
    orbit: f32,
}

impl Shot {
    /// Chooses the camera. What the arguments do not set is chosen so that the bodies of the survey are in view.
    pub(super) fn new(arguments: &Arguments, survey: &Survey, simulation: &mut Simulation) -> Result<Self, Failure> {
        let [width, height] = arguments.size.map(|side| side as f32);
        let scene = simulation.sync()?;
        let orbit = arguments.orbit.unwrap_or(0.0).to_radians();
        let framing = Camera::of_survey(survey, scene, width / height, orbit != 0.0);
        let follow = arguments.follow.map(|number| body(scene, number)).transpose()?;
        let mut eye = framing.eye;
        let mut target = arguments.look_at.map_or(framing.target, Into::into);
        if let Some(sphere) = follow {
            let sphere = scene.sphere(sphere)?;
            let whole = framing.eye - framing.target;
            let distance = (FOLLOW_PART * whole.length()).max(FOLLOW_RADII * sphere.radius);
            target = sphere.position;
            eye = target + distance * whole.normalize_or(Vec3::Z);
        }
        let eye = arguments.camera.map_or(eye, Into::into);
        if eye == target {
            return Err(Failure::usage("--camera and --look-at are the same point, expected two different points"));
        }
        Ok(Self { camera: Camera { eye, target, ..framing }, follow, orbit })
    }

    /// The options that give this camera; `None` if the arguments have them.
    pub(super) fn options(&self, arguments: &Arguments) -> Option<String> {
        let has_target = arguments.look_at.is_some() || arguments.follow.is_some();
        if arguments.camera.is_some() && has_target {
            return None;
        }
        let Camera { eye, target, .. } = self.camera;
        // About four digits of the distance: the picture does not depend on more.
        let decimals = (3.0 - eye.distance(target).log10().floor()).clamp(0.0, 40.0) as usize;
        let written = |point: Vec3| point.to_array().map(|number| format!("{number:.decimals$}")).join(",");
        let look_at = match arguments.follow {
            Some(number) => format!("--follow {number}"),
            None => format!("--look-at {}", written(target)),
        };
        Some(format!("--camera {} {look_at}", written(eye)))
    }

    /// The camera `seconds` after the start of the film, with the place of the body that it follows.
    pub(super) fn at(&self, seconds: f64, followed: Option<Vec3>) -> Camera {
        let camera = self.camera.orbited((f64::from(self.orbit) * seconds) as f32);
        followed.map_or(camera, |place| camera.looking_at(place))
    }

    pub(super) fn follows(&self) -> bool {
        self.follow.is_some()
    }

    /// The present place of the body that the camera follows.
    pub(super) fn followed(&self, simulation: &mut Simulation) -> rockfall::Result<Option<Vec3>> {
        let place = |sphere| simulation.sphere(sphere).map(|state| state.position);
        self.follow.map(place).transpose()
    }
}

/// Finds the sphere that a number means: the last one with this reference in the scene text, which is what a line of the scene
/// would mean. A scene without references is numbered in the order of addition, from 0.
pub(super) fn body(scene: &Scene, number: u32) -> Result<SphereId, Failure> {
    let has_references = scene.sphere_ids().any(|sphere| scene.reference(sphere).is_some());
    let found = match has_references {
        true => scene.sphere_ids().filter(|sphere| scene.reference(*sphere) == Some(number)).last(),
        false => scene.sphere_ids().nth(number as usize),
    };
    found.ok_or_else(|| Failure::usage(format!("there is no sphere {number} in the scene")))
}
