//! State of the window, and how commands and the mouse change it, independently of any window.

use std::path::{Path, PathBuf};

use rockfall::Scene;
use rockfall::glam::Vec2;

use super::constants::CONSTANTS;
use super::controls::Command;
use super::dialog::Dialog;
use super::hold::Sight;
use super::navigation::{self, Arrow, Arrows};
use super::rates::Rates;
use super::session::Session;
use crate::camera::Camera;
use crate::draw::Style;
use crate::legend::Legend;

/// Movement of the pointer, in pixels, below which a press and release is a click.
const CLICK: f32 = 4.0;
/// Time that a thrown sphere takes to the target of the camera, in s.
const FLIGHT: f32 = 0.8;
/// Least duration that a press of an arrow key counts for, in s.
const TAP: f64 = 0.05;

/// A mouse button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// Left button.
    Left,
    /// Middle button.
    Middle,
    /// Right button.
    Right,
}

/// Action of the mouse while a button is down.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// A click, as long as the pointer stays near the position of the press.
    Press(Vec2),
    Turn,
    Orbit,
    Raise,
    Hold,
}

/// State of the window.
pub struct Viewer {
    /// The scene.
    pub session: Session,
    /// The camera.
    pub camera: Camera,
    size: Vec2,
    /// The camera that was computed when the scene was framed last.
    framed: Camera,
    /// Whether the table of keys is shown.
    pub help: bool,
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether the window should close.
    pub quit: bool,
    arrows: Arrows,
    /// Folders in which the key R looks for `input.txt`.
    pub input_folders: Vec<PathBuf>,
    /// The file that Ctrl+S saves to.
    pub save_as: PathBuf,
    /// The file dialog.
    pub dialog: Dialog,
    /// Style of the picture.
    pub style: Style,
    /// Legend of the last picture.
    pub legend: Option<Legend>,
    /// Frames and steps per second.
    pub rates: Rates,
    /// Position of the pointer in the picture, in pixels.
    pointer: Option<Vec2>,
    /// The button that is down, and its action.
    drag: Option<(Button, Drag)>,
    scene_seen: u64,
}

impl Viewer {
    /// Creates a viewer with a picture of this size, in pixels, whose camera shows the whole scene.
    pub fn new(session: Session, size: Vec2) -> Self {
        let camera = framing(&session.source().scene, size);
        Self {
            session,
            camera,
            framed: camera,
            size,
            help: false,
            panel: true,
            quit: false,
            arrows: Arrows::default(),
            input_folders: default_input_folders(),
            save_as: PathBuf::from("saved.txt"),
            dialog: Dialog::default(),
            style: Style::default(),
            legend: None,
            rates: Rates::default(),
            pointer: None,
            drag: None,
            scene_seen: 0,
        }
    }

    /// Executes a command.
    pub fn command(&mut self, command: Command) {
        let session = &mut self.session;
        match command {
            Command::Help => self.help = !self.help,
            Command::TogglePanel => self.panel = !self.panel,
            Command::Quit if self.dialog.is_shown() => self.dialog.close(),
            Command::Quit => self.quit = true,
            Command::Open => self.dialog.open(false),
            Command::SaveAs => self.dialog.open(true),
            Command::ToggleRunning => session.toggle_running(),
            Command::SingleStep => session.single_step(),
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
            Command::Reset => session.reset(),
            Command::ResetCamera => self.frame_scene(),
            Command::ChangeSpeed { faster } => session.pace.change_speed(faster),
            Command::Save => session.save(&self.save_as),
        }
        self.frame_if_new_scene();
    }

    /// Opens a scene file.
    pub fn load(&mut self, path: &Path) {
        self.session.load(path);
        self.frame_if_new_scene();
    }

    /// Saves the present state.
    pub fn save(&mut self) {
        self.session.save(&self.save_as);
    }

    /// Moves the camera if another scene was opened. When the same scene is loaded again, the camera stays.
    fn frame_if_new_scene(&mut self) {
        if self.session.scene_version() != self.scene_seen {
            self.scene_seen = self.session.scene_version();
            self.frame_scene();
        }
    }

    fn frame_scene(&mut self) {
        self.camera = framing(&self.session.source().scene, self.size);
        self.framed = self.camera;
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

    /// Handles a button press over the picture; ignored while another button is down.
    pub fn press(&mut self, button: Button, ctrl: bool) {
        if self.drag.is_some() {
            return;
        }
        let drag = match button {
            Button::Left if ctrl => {
                let sight = self.sight();
                self.session.hold(&sight);
                Drag::Hold
            }
            Button::Left => Drag::Press(self.pointer.unwrap_or_default()),
            Button::Middle => Drag::Orbit,
            Button::Right => Drag::Raise,
        };
        self.drag = Some((button, drag));
    }

    /// Whether a button that was pressed over the picture is still down.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Handles the release of a button.
    pub fn release(&mut self, button: Button) {
        match self.drag.take_if(|(pressed, _)| *pressed == button) {
            Some((_, Drag::Press(_))) => {
                let sight = self.sight();
                self.session.pick(sight.origin, sight.direction);
            }
            Some((_, Drag::Hold)) => self.session.release(),
            _ => {}
        }
    }

    /// Handles a movement of the pointer to a position in the picture, in pixels from the upper left corner; `None` if it left.
    pub fn point(&mut self, pixel: Option<Vec2>) {
        let moved = pixel.zip(self.pointer).map_or(Vec2::ZERO, |(now, before)| now - before);
        self.pointer = pixel;
        let Some((_, drag)) = &mut self.drag else {
            return;
        };
        match drag {
            Drag::Press(start) => {
                let far = pixel.map_or(Vec2::ZERO, |now| now - *start);
                if far.length() >= CLICK {
                    *drag = Drag::Turn;
                    navigation::turn(&mut self.camera, far.x, far.y);
                }
            }
            Drag::Turn => navigation::turn(&mut self.camera, moved.x, moved.y),
            Drag::Orbit => navigation::orbit(&mut self.camera, moved.x, moved.y),
            Drag::Raise => navigation::raise(&mut self.camera, moved.y / self.size.y),
            Drag::Hold => self.drag_held(),
        }
    }

    fn drag_held(&mut self) {
        let sight = self.sight();
        self.session.drag(&sight);
    }

    /// Zooms by a number of notches of the wheel.
    pub fn scroll(&mut self, notches: f32) {
        navigation::zoom(&mut self.camera, notches);
    }

    /// Handles a press or release of an arrow key. Even the shortest press moves the camera.
    pub fn arrow(&mut self, arrow: Arrow, down: bool) {
        let (before, only) = (self.arrows, Arrows::only(arrow));
        self.arrows.set(arrow, down);
        if down && before != self.arrows {
            self.walk_by(only, TAP);
        }
    }

    /// Releases all arrow keys, because the window lost the keyboard focus.
    pub fn release_arrows(&mut self) {
        self.arrows = Arrows::default();
    }

    /// Moves the camera for `elapsed` s with the arrow keys that are down.
    pub fn walk(&mut self, elapsed: f64) {
        self.walk_by(self.arrows, elapsed);
    }

    fn walk_by(&mut self, arrows: Arrows, seconds: f64) {
        navigation::walk(&mut self.camera, arrows, seconds as f32);
        if matches!(self.drag, Some((_, Drag::Hold))) && arrows.any() {
            self.drag_held();
        }
    }

    /// Whether the picture changes without input.
    pub fn is_moving(&self) -> bool {
        self.session.running() || self.arrows.any()
    }
}

fn framing(scene: &Scene, size: Vec2) -> Camera {
    Camera::of_scene(scene, size.x / size.y)
}

/// Returns the working directory and the folder of the program.
fn default_input_folders() -> Vec<PathBuf> {
    let program = std::env::current_exe().ok().and_then(|path| path.parent().map(PathBuf::from));
    std::env::current_dir().ok().into_iter().chain(program).collect()
}
