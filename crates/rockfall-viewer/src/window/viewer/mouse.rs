//! The mouse, the touchpad and the arrow keys.

use rockfall::glam::{Vec2, Vec3};

use super::Viewer;
use crate::whole::ball;
use crate::window::controls::{Controls, Modifiers};
use crate::window::hold::Sight;
use crate::window::navigation::{self, Arrow, Arrows};

/// Movement of the pointer, in pixels, below which a press and release is a click.
const CLICK: f32 = 4.0;
/// Greatest time between the clicks of a double click, in s.
const DOUBLE: f64 = 0.4;
/// Least duration that a press of an arrow key counts for, in s.
const TAP: f64 = 0.05;
/// Notches of the wheel for a drag over the height of the picture (Alt + right drag).
const DRAG_NOTCHES: f32 = 20.0;
/// Number of objects above which a zoom does not look for the body under the pointer, because that takes too long.
const LARGE: usize = 200_000;

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
pub(super) enum Drag {
    /// A click, as long as the pointer stays near the position of the press. Then the movement begins.
    Press(Vec2, Move),
    Move(Move),
    Hold,
}

/// Movement of the camera by a drag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    Turn,
    Orbit,
    Raise,
    Pan,
    Zoom,
}

fn movement(controls: Controls, button: Button, held: Modifiers) -> Move {
    match (controls, button) {
        (Controls::Standard, Button::Left) if held.alt || held.shift => Move::Pan,
        (Controls::Standard, Button::Left) | (Controls::Thesis, Button::Middle) => Move::Orbit,
        (Controls::Standard, Button::Right) if held.alt => Move::Zoom,
        (Controls::Standard, Button::Right | Button::Middle) => Move::Pan,
        (Controls::Thesis, Button::Left) => Move::Turn,
        (Controls::Thesis, Button::Right) => Move::Raise,
    }
}

impl Viewer {
    /// Handles a button press over the picture; ignored while another button is down.
    pub fn press(&mut self, button: Button, held: Modifiers) {
        if self.drag.is_some() {
            return;
        }
        let drag = if button == Button::Left && held.ctrl {
            let sight = self.sight();
            self.session.hold(&sight);
            Drag::Hold
        } else {
            let movement = movement(self.controls, button, held);
            match button {
                Button::Left => Drag::Press(self.pointer.unwrap_or_default(), movement),
                _ => Drag::Move(movement),
            }
        };
        self.drag = Some((button, drag));
    }

    /// Whether a button that was pressed over the picture is still down.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Handles the release of a button; `now` is the time in s.
    pub fn release(&mut self, button: Button, now: f64) {
        match self.drag.take_if(|(pressed, _)| *pressed == button) {
            Some((_, Drag::Press(place, _))) => self.click(place, now),
            Some((_, Drag::Hold)) => self.session.release(),
            _ => {}
        }
    }

    fn click(&mut self, place: Vec2, now: f64) {
        let sight = self.sight();
        let point = self.session.pick(sight.origin, sight.direction);
        let double = self.clicked.is_some_and(|(at, when)| at.distance(place) < 2.0 * CLICK && now - when < DOUBLE);
        self.clicked = (!double).then_some((place, now));
        if let (true, Some(point)) = (double, point) {
            self.focus(point);
        }
    }

    /// Moves the camera to the picked body, or to the point of a box or polygon that was clicked.
    fn focus(&mut self, point: Vec3) {
        let scene = self.session.simulation_ref().scene();
        let body = self.session.picked().and_then(|body| ball(scene, body));
        match body {
            Some((centre, radius)) => navigation::focus(&mut self.camera, centre, radius),
            None => {
                // From the present distance, because boxes may be large.
                self.camera.eye += point - self.camera.target;
                self.camera.target = point;
            }
        }
        self.keep_in_limits();
    }

    /// Handles a movement of the pointer to a position in the picture, in pixels from the upper left corner; `None` if it left.
    pub fn point(&mut self, pixel: Option<Vec2>) {
        let moved = pixel.zip(self.pointer).map_or(Vec2::ZERO, |(now, before)| now - before);
        self.pointer = pixel;
        let Some((_, drag)) = &mut self.drag else {
            return;
        };
        match *drag {
            Drag::Press(start, movement) => {
                let far = pixel.map_or(Vec2::ZERO, |now| now - start);
                if far.length() >= CLICK {
                    *drag = Drag::Move(movement);
                    self.move_camera(movement, far);
                }
            }
            Drag::Move(movement) => self.move_camera(movement, moved),
            Drag::Hold => self.drag_held(),
        }
    }

    fn move_camera(&mut self, movement: Move, pixels: Vec2) {
        if pixels == Vec2::ZERO {
            return;
        }
        let part = pixels / self.size.y;
        match movement {
            Move::Turn => navigation::turn(&mut self.camera, pixels.x, pixels.y),
            Move::Orbit => navigation::orbit(&mut self.camera, pixels.x, pixels.y),
            Move::Raise => navigation::raise(&mut self.camera, part.y),
            Move::Pan => navigation::pan(&mut self.camera, part),
            Move::Zoom => {
                let (target, least) = (self.camera.target, self.limits().least);
                navigation::zoom(&mut self.camera, -DRAG_NOTCHES * part.y, target, least);
            }
        }
        // Turning looks away from the scene on purpose.
        if !matches!(movement, Move::Turn | Move::Raise) {
            self.keep_in_limits();
        }
    }

    fn keep_in_limits(&mut self) {
        let limits = self.limits();
        limits.keep(&mut self.camera);
    }

    fn drag_held(&mut self) {
        let sight = self.sight();
        self.session.drag(&sight);
    }

    /// Zooms by a number of notches of the wheel to what is under the pointer.
    pub fn scroll(&mut self, notches: f32) {
        let sight = self.sight();
        let depth = self.camera.eye.distance(self.camera.target);
        let counts = self.session.simulation_ref().scene().counts();
        let few = counts.spheres + counts.rods + counts.boxes + counts.polygons <= LARGE;
        let body = if few && !self.session.device_failed() { self.session.look(&sight) } else { None };
        let point = body.unwrap_or_else(|| Sight::at_depth(&sight, depth));
        let least = self.limits().least;
        navigation::zoom(&mut self.camera, notches, point, least);
        self.keep_in_limits();
    }

    /// Moves the picture with the fingers on a touchpad, by a number of pixels to the right and down.
    pub fn slide(&mut self, pixels: Vec2) {
        self.move_camera(Move::Pan, pixels);
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
        if !arrows.any() {
            return;
        }
        navigation::walk(&mut self.camera, arrows, seconds as f32);
        if self.controls == Controls::Standard {
            self.keep_in_limits();
        }
        if matches!(self.drag, Some((_, Drag::Hold))) {
            self.drag_held();
        }
    }
}
