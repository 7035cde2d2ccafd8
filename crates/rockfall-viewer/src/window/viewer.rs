//! State of the window, and how commands and the mouse change it, independently of any window.

use std::path::PathBuf;

use rockfall::Scene;
use rockfall::glam::Vec2;

use super::capture::Capture;
use super::constants::CONSTANTS;
use super::controls::{Command, Controls};
use super::dialog::Dialog;
use super::follow::Find;
use super::hold::Sight;
use super::navigation::{self, Arrows, Limits};
use super::rates::Rates;
use super::session::Session;
use crate::bounds::bounds_of_survey;
use crate::camera::{Camera, Direction, Vertical};
use crate::draw::Style;
use crate::legend::Legend;
use crate::overlay::Overlay;
use crate::survey::Survey;

mod files;
mod follow;
mod keep;
mod mouse;

use files::SavedFile;
use follow::Follow;
use keep::Kept;
pub use mouse::Button;
use mouse::Drag;

/// Time that a thrown sphere takes to the target of the camera, in s.
const FLIGHT: f32 = 0.8;
/// Time after which the limits of the camera are computed again while the scene moves, in s.
const LIMITS_INTERVAL: f64 = 0.5;

/// State of the window.
pub struct Viewer {
    /// The scene.
    pub session: Session,
    /// What the mouse does.
    pub controls: Controls,
    /// The camera.
    pub camera: Camera,
    size: Vec2,
    /// Position of the picture in the window, in pixels from the upper left corner.
    pub origin: Vec2,
    /// The camera that was computed when the scene was framed last.
    framed: Camera,
    /// Limits of the camera, with the number of steps and the time at which they were computed.
    limits: Option<(Limits, u64, f64)>,
    /// Whether the table of keys is shown.
    pub help: bool,
    /// Whether all messages are shown.
    pub messages: bool,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether a menu is open or a field has the keyboard focus, so that Escape only closes it.
    pub busy: bool,
    /// Whether the user is asked about unsaved changes, because the window should close.
    pub leaving: bool,
    /// Whether the window should close.
    pub quit: bool,
    arrows: Arrows,
    /// Folders in which the key R looks for `input.txt`.
    pub input_folders: Vec<PathBuf>,
    /// Folder of pictures, films and tables.
    pub folder: PathBuf,
    /// The file that the present scene was saved to.
    saved: Option<SavedFile>,
    /// The file dialog.
    pub dialog: Dialog,
    /// Screenshots and recordings.
    pub capture: Capture,
    /// Style of the picture.
    pub style: Style,
    /// Text, arrows and trails over the picture.
    pub overlay: Overlay,
    /// Legend of the last picture.
    pub legend: Option<Legend>,
    /// Frames and steps per second.
    pub rates: Rates,
    /// Position of the pointer in the picture, in pixels.
    pointer: Option<Vec2>,
    /// The button that is down, and its action.
    drag: Option<(Button, Drag)>,
    /// Position and time, in s, of the last click, to recognise a double click.
    clicked: Option<(Vec2, f64)>,
    scene_seen: u64,
    /// Direction from which the camera shows every scene that is opened.
    direction: Direction,
    /// How the axis upwards is chosen.
    vertical: Vertical,
    /// Finds the sphere that the camera follows in every scene that is opened.
    pub find: Option<Find>,
    /// Find the spheres that are plotted in every scene that is opened.
    pub plotted: Vec<Find>,
    /// What the camera moves with.
    follow: Option<Follow>,
    /// What the camera keeps in the picture.
    kept: Option<Kept>,
}

impl Viewer {
    /// Creates a viewer with a picture of this size, in pixels, whose camera shows the whole scene.
    pub fn new(session: Session, size: Vec2) -> Self {
        let camera = framing(&session, size, Direction::default(), Vertical::Auto);
        let mut viewer = Self {
            session,
            controls: Controls::default(),
            camera,
            framed: camera,
            limits: None,
            size,
            origin: Vec2::ZERO,
            help: false,
            messages: false,
            panel: true,
            busy: false,
            leaving: false,
            quit: false,
            arrows: Arrows::default(),
            input_folders: default_input_folders(),
            folder: PathBuf::new(),
            saved: None,
            dialog: Dialog::default(),
            capture: Capture::default(),
            style: Style::default(),
            overlay: Overlay::default(),
            legend: None,
            rates: Rates::default(),
            pointer: None,
            drag: None,
            clicked: None,
            scene_seen: 0,
            follow: None,
            kept: None,
            find: None,
            plotted: Vec::new(),
            direction: Direction::default(),
            vertical: Vertical::Auto,
        };
        viewer.follow_initially();
        viewer
    }

    /// Shows this scene and all that are opened later from a direction, with an axis upwards.
    pub fn show_from(&mut self, direction: Direction, vertical: Vertical) {
        (self.direction, self.vertical) = (direction, vertical);
        self.frame_scene();
    }

    /// Executes a command.
    pub fn command(&mut self, command: Command) {
        let session = &mut self.session;
        match command {
            Command::Help => self.help = !self.help,
            Command::ToggleMessages => self.messages = !self.messages,
            Command::TogglePanel => self.panel = !self.panel,
            Command::Close => self.escape(),
            Command::Quit => self.leave(),
            Command::Open => self.ask_for_file(false),
            Command::Save => self.save(),
            Command::SaveAs => self.ask_for_file(true),
            Command::Screenshot => self.capture.ask_for_screenshot(),
            Command::ToggleRunning => session.toggle_running(),
            Command::SingleStep => session.single_step(),
            Command::Rewind { forward } => session.rewind(forward),
            Command::LoadInput => session.load_input(&self.input_folders),
            Command::LoadGiven => session.load_given(),
            Command::ToggleCollisions => session.change_settings(|settings| settings.collisions = !settings.collisions),
            Command::ToggleRealTime => {
                session.pace.real_time = !session.pace.real_time;
                session.pace.forget();
            }
            Command::Nudge { constant, up } => {
                session.change_settings(|settings| CONSTANTS[constant].nudge(settings, up));
            }
            Command::Throw => self.throw(),
            Command::Undo => session.undo(),
            Command::Redo => session.redo(),
            Command::Reset => session.reset(),
            Command::Restart => {
                session.reset();
                session.set_running(true);
            }
            Command::ResetCamera => self.frame_scene(),
            Command::FrameAll => self.frame_all(),
            Command::Follow => self.toggle_follow(),
            Command::LookFrom(direction) => {
                let distance = self.camera.eye.distance(self.camera.target);
                self.camera.eye = self.camera.target + distance * self.camera.up.to_scene(direction.to_camera());
                self.frame_all();
            }
            Command::ChangeSpeed { faster } => session.pace.change_speed(faster),
        }
        self.frame_if_new_scene();
    }

    /// Closes the topmost thing that is open: a question, the file dialog, a menu or field, the tables, the window of the picked body.
    /// If nothing is open, ends a recording or else the program.
    fn escape(&mut self) {
        if self.leaving {
            self.leaving = false;
        } else if self.dialog.is_shown() {
            self.dialog.cancel();
        } else if self.busy {
            // The widgets close menus and leave fields by themselves.
            self.busy = false;
        } else if self.help {
            self.help = false;
        } else if self.messages {
            self.messages = false;
        } else if self.session.picked().is_some() {
            self.session.set_picked(None);
        } else if self.capture.is_recording() {
            self.stop_recording();
        } else {
            self.leave();
        }
    }

    /// Ends the program, or asks about unsaved changes. The same command while the question is shown loses them.
    pub fn leave(&mut self) {
        let asks = self.session.is_changed() && !self.leaving;
        (self.leaving, self.quit) = (asks, !asks);
    }

    /// Moves the camera if another scene was opened. When the same scene is loaded again, the camera stays.
    fn frame_if_new_scene(&mut self) {
        if self.session.scene_version() != self.scene_seen {
            self.scene_seen = self.session.scene_version();
            self.frame_scene();
            self.follow_initially();
            self.plot_initially();
        }
    }

    fn frame_scene(&mut self) {
        self.camera = framing(&self.session, self.size, self.direction, self.vertical);
        self.framed = self.camera;
        (self.limits, self.kept) = (None, None);
        self.follow_from_start();
    }

    fn frame_all(&mut self) {
        let aspect = self.aspect();
        let up = self.camera.up;
        let bounds = |scene: &Scene| bounds_of_survey(&Survey::with_up(scene, up), scene);
        match self.session.simulation().sync().map(bounds) {
            Ok(bounds) => navigation::frame_all(&mut self.camera, bounds, aspect),
            Err(error) => self.session.fail(&error),
        }
        self.limits = None;
    }

    /// Returns the limits of the camera for the present scene.
    fn limits(&mut self) -> Limits {
        let (steps, now) = (self.session.simulation_ref().report().steps, self.session.now());
        let known = self.limits.filter(|(_, at, when)| *at == steps || now - when < LIMITS_INTERVAL);
        let survey = self.session.played().and_then(|playback| playback.survey.as_ref());
        let limits = || Limits::of(self.session.simulation_ref().scene(), survey, self.camera.up);
        let (limits, ..) = known.unwrap_or_else(|| (limits(), steps, now));
        if known.is_none() {
            self.limits = Some((limits, steps, now));
        }
        limits
    }

    /// Returns the width and height of the picture, in pixels.
    pub fn size(&self) -> Vec2 {
        self.size
    }

    /// Sets the size of the picture. A camera that was not moved since it was framed is framed again for the new size.
    pub fn resize(&mut self, size: Vec2) {
        let size = size.round().max(Vec2::ONE);
        if size != self.size {
            self.size = size;
            if self.camera == self.framed {
                self.frame_scene();
            }
        }
    }

    /// Returns the width of the picture divided by its height.
    pub fn aspect(&self) -> f32 {
        self.size.x / self.size.y
    }

    /// Returns the line of sight through the pointer, or through the middle of the picture if the pointer is outside.
    fn sight(&self) -> Sight {
        let ndc = self.pointer.map_or(Vec2::ZERO, |pixel| (pixel / self.size * 2.0 - 1.0) * Vec2::new(1.0, -1.0));
        let (origin, direction) = self.camera.ray(ndc.x, ndc.y, self.aspect());
        Sight { origin, direction, forward: self.camera.axes().forward }
    }

    fn throw(&mut self) {
        let sight = self.sight();
        let distance = self.camera.eye.distance(self.camera.target);
        self.session.throw(sight.origin + 0.1 * distance * sight.direction, distance / FLIGHT * sight.direction);
    }

    /// Whether the picture changes without input.
    pub fn is_moving(&self) -> bool {
        self.session.running() || self.arrows.any() || self.is_easing()
    }
}

/// A camera that shows the initial scene, or all frames of a trajectory.
fn framing(session: &Session, size: Vec2, direction: Direction, vertical: Vertical) -> Camera {
    let (scene, aspect) = (&session.source().scene, size.x / size.y);
    match session.played().and_then(|playback| playback.survey.as_ref()) {
        Some(survey) => Camera::of_survey(survey, scene, aspect, direction, false),
        None => Camera::of_scene_with_up(scene, vertical.of(scene), aspect, direction),
    }
}

/// Returns the working directory and the folder of the program.
fn default_input_folders() -> Vec<PathBuf> {
    let program = std::env::current_exe().ok().and_then(|path| path.parent().map(PathBuf::from));
    std::env::current_dir().ok().into_iter().chain(program).collect()
}
