//! The arguments of a window, and the reasons why it ends early.

use std::cell::RefCell;
use std::fmt;
use std::path::PathBuf;

use rockfall::{Error, Options};

use super::controls::Controls;
use super::follow::Find;
use super::session::playback::Playback;
use super::session::{Prepare, Source};
use crate::camera::{Direction, Vertical};
use crate::draw::Style;
use crate::overlay::Overlay;
use crate::plot::Plot;

/// Arguments of [`run`](super::run).
pub struct Launch {
    /// The initial scene.
    pub source: Source,
    /// Warnings about the scene, which are shown as messages.
    pub warnings: Vec<String>,
    /// The trajectory to play, whose scene is the initial one.
    pub playback: RefCell<Option<Playback>>,
    /// Options of the simulation.
    pub options: Options,
    /// Time step, in s.
    pub time_step: f32,
    /// Whether scenes that are opened later have this time step, whatever their own is.
    pub keeps_time_step: bool,
    /// Constants that override those of every scene: name and value.
    pub overrides: Vec<(String, String)>,
    /// What the mouse does.
    pub controls: Controls,
    /// Text, arrows and trails over the picture.
    pub overlay: Overlay,
    /// Style of the picture.
    pub style: Style,
    /// Changes every scene that is opened later, such as its colours.
    pub prepare: Option<Prepare>,
    /// Direction from which the camera shows scenes.
    pub view: Direction,
    /// How the axis upwards is chosen.
    pub up: Vertical,
    /// Finds the sphere that the camera follows.
    pub follow: Option<Find>,
    /// Find the spheres whose motion is plotted: the first one is picked.
    pub plotted: Vec<Find>,
    /// Plots of joints.
    pub joints: Vec<Plot>,
    /// File to write the state to after every frame and on exit, as JSON.
    pub report: Option<PathBuf>,
    /// Number of frames after which the device is destroyed, for tests.
    pub lose_device_after: Option<u64>,
}

/// Reason why a window could not be opened or ended early.
#[derive(Debug)]
pub enum Failure {
    /// There is no display.
    NoDisplay(String),
    /// The scene could not be opened, or the device failed too often.
    Rockfall(Error),
    /// The report could not be written.
    Report(PathBuf, std::io::Error),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisplay(why) => {
                write!(f, "no window can be opened here: {why}; `rockfall render` makes pictures and films without one")
            }
            Self::Rockfall(error) => error.fmt(f),
            Self::Report(path, error) => write!(f, "{}: cannot be written: {error}", path.display()),
        }
    }
}

impl std::error::Error for Failure {}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Rockfall(error)
    }
}
