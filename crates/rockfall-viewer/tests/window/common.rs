//! Sessions and viewers with small scenes.

use std::path::{Path, PathBuf};

use rockfall::glam::Vec2;
use rockfall::{Backend, Options, Scene, Simulation};
use rockfall_viewer::window::controls::Modifiers;
use rockfall_viewer::window::session::{Opener, Session, Source};
use rockfall_viewer::window::viewer::Viewer;

/// A ball at rest above a box.
pub(crate) const BALL: &str = "S 1 0 3 0 0 0 0 0 0 0 1 0.5\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n";

/// Two balls in zero gravity, 4 units apart.
pub(crate) const FLOATING: &str = "set gravity 0\nS 1 -2 0 0 0 0 0 0 0 0 1 0.5\nS 2 2 0 0 0 0 0 0 0 0 1 0.5\n";

pub(crate) fn on_cpu() -> Opener {
    Box::new(|scene: Scene| Simulation::with_options(scene, Options::new().backend(Backend::Cpu)))
}

pub(crate) fn source(text: &str, path: Option<PathBuf>) -> Source {
    let scene = Scene::parse(text, Path::new("test")).expect("a good scene").scene;
    Source { name: "test".to_owned(), path, scene }
}

/// A session in which each frame is one step.
pub(crate) fn session(text: &str) -> Session {
    let mut session = Session::open(source(text, None), Vec::new(), 0.02, on_cpu()).expect("it opens");
    session.pace.real_time = false;
    session
}

/// A viewer with a picture of 800 x 600 pixels.
pub(crate) fn viewer(text: &str) -> Viewer {
    let mut viewer = Viewer::new(session(text), Vec2::new(800.0, 600.0));
    viewer.input_folders = Vec::new();
    viewer
}

pub(crate) const NONE: Modifiers = Modifiers { shift: false, ctrl: false, alt: false };
pub(crate) const CTRL: Modifiers = Modifiers { ctrl: true, ..NONE };

/// Returns the messages of a session, the last first.
pub(crate) fn messages(session: &Session) -> Vec<&str> {
    session.messages.all().iter().rev().map(|message| message.text.as_str()).collect()
}

/// Returns the heights of all spheres.
pub(crate) fn heights(session: &mut Session) -> Vec<f32> {
    session.simulation().spheres().expect("spheres are read").iter().map(|sphere| sphere.position.y).collect()
}
