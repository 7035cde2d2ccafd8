//! The camera of a picture or a film.

use std::fmt;

use rockfall::glam::Vec3;
use rockfall::{Body, Scene, Simulation, SphereId};
use rockfall_viewer::camera::Camera;
use rockfall_viewer::film::{self, Subject, View};
use rockfall_viewer::plot::{bodies_named, named};
use rockfall_viewer::survey::Survey;

use super::Arguments;
use crate::failure::Failure;

/// A camera that may follow a body or creatures and orbit.
pub(super) struct Shot {
    shot: film::Shot,
    follow: Option<Subject>,
}

impl Shot {
    /// Chooses the camera. What the arguments do not set is chosen so that the bodies of the survey are in view, or so that the camera
    /// moves with the creatures of the scene.
    pub(super) fn new(arguments: &Arguments, survey: &Survey, simulation: &mut Simulation) -> Result<Self, Failure> {
        let [width, height] = arguments.layout().scene().map(|side| side as f32);
        let scene = simulation.sync()?;
        let given = arguments.follow.as_ref().map(|what| what.of(scene, "--follow")).transpose()?;
        let is_free = arguments.camera.is_none() && arguments.look_at.is_none();
        let creatures = || Subject::creatures(scene).filter(|_| is_free);
        let view = View {
            from: arguments.view.unwrap_or_default(),
            camera: arguments.camera.map(Into::into),
            look_at: arguments.look_at.map(Into::into),
            follow: given.map(|sphere| Subject::of(scene, sphere)).or_else(creatures),
            orbit: arguments.orbit.unwrap_or(0.0).to_radians(),
            room_above: arguments.captions.overlay().room_above(arguments.layout().scene()),
        };
        let same = || Failure::usage("--camera and --look-at are the same point, expected two different points");
        let shot = film::Shot::new(&view, survey, scene, width / height)?.ok_or_else(same)?;
        Ok(Self { shot, follow: view.follow })
    }

    /// The options that give this camera; `None` if the arguments have them, and for a camera that moves with creatures.
    pub(super) fn options(&self, arguments: &Arguments) -> Option<String> {
        let has_target = arguments.look_at.is_some() || arguments.follow.is_some();
        if arguments.camera.is_some() && has_target || matches!(self.follow, Some(Subject::Creatures(_))) {
            return None;
        }
        let Camera { eye, target, .. } = self.shot.camera();
        // About four digits of the distance: the picture does not depend on more.
        let decimals = (3.0 - eye.distance(target).log10().floor()).clamp(0.0, 40.0) as usize;
        let written = |point: Vec3| point.to_array().map(|number| format!("{number:.decimals$}")).join(",");
        let look_at = match &arguments.follow {
            Some(what) => format!("--follow {what}"),
            None => format!("--look-at {}", written(target)),
        };
        Some(format!("--camera {} {look_at}", written(eye)))
    }

    /// The camera `seconds` after the start of the film, with the place of what it follows.
    pub(super) fn at(&self, seconds: f64, followed: Option<Vec3>) -> Camera {
        self.shot.at(seconds, followed)
    }

    /// What the camera follows.
    pub(super) fn followed(&self) -> Option<&Subject> {
        self.follow.as_ref()
    }
}

/// A body in an argument: the number of a sphere, or a name in the scene.
#[derive(Clone, Debug)]
pub(crate) enum Named {
    Number(u32),
    Name(String),
}

impl Named {
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if text.starts_with(char::is_alphabetic) || text.starts_with('_') {
            return Ok(Self::Name(text.to_owned()));
        }
        let expected = |_| format!("expected the number of a sphere from 0 to {}, or a name in the scene", u32::MAX);
        text.parse().map(Self::Number).map_err(expected)
    }

    /// The bodies that `option` means: all those with a name.
    pub(crate) fn bodies(&self, scene: &Scene, option: &str) -> Result<Vec<Body>, Failure> {
        match self {
            Self::Number(number) => body(scene, *number).map(|sphere| vec![Body::Sphere(sphere)]),
            Self::Name(name) => bodies_named(scene, name).map_err(|error| Failure::usage(format!("{option} {error}"))),
        }
    }

    /// The sphere that `option` means.
    pub(crate) fn of(&self, scene: &Scene, option: &str) -> Result<SphereId, Failure> {
        match self {
            Self::Number(number) => body(scene, *number),
            Self::Name(name) => named(scene, name).map_err(|error| Failure::usage(format!("{option} {error}"))),
        }
    }
}

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Name(name) => name.fmt(f),
        }
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
