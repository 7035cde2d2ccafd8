//! Moves the camera with the arrow keys and the mouse.

use rockfall::glam::{Quat, Vec3};

use crate::camera::Camera;

/// Rotation per pixel of a drag, in rad.
const TURN: f32 = 0.004;
/// Greatest pitch up or down, in rad. Straight up or down, left and right would be undefined.
const STEEPEST: f32 = 1.55;
/// Speed of the camera with the arrow keys, in distances of the target per second.
const WALK: f32 = 0.7;
/// Factor on the distance of the target per notch of the wheel.
const ZOOM: f32 = 0.88;

/// An arrow key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    /// Moves forwards.
    Up,
    /// Moves backwards.
    Down,
    /// Moves to the left.
    Left,
    /// Moves to the right.
    Right,
}

/// The arrow keys that are down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arrows([bool; 4]);

impl Arrows {
    /// Returns a set with one arrow.
    pub fn only(arrow: Arrow) -> Self {
        let mut arrows = Self::default();
        arrows.set(arrow, true);
        arrows
    }

    /// Presses or releases an arrow.
    pub fn set(&mut self, arrow: Arrow, down: bool) {
        self.0[arrow as usize] = down;
    }

    /// Whether any arrow is down.
    pub fn any(self) -> bool {
        self != Self::default()
    }

    /// Returns 1 if only `plus` is down, -1 if only `minus` is down, else 0.
    fn sign(self, plus: Arrow, minus: Arrow) -> f32 {
        f32::from(u8::from(self.0[plus as usize])) - f32::from(u8::from(self.0[minus as usize]))
    }
}

/// Returns the distance between camera and target, in units.
fn distance(camera: &Camera) -> f32 {
    camera.eye.distance(camera.target)
}

/// Returns the viewing direction after a rotation by a drag of `dx`, `dy` pixels, with limited pitch.
fn rotated(forward: Vec3, dx: f32, dy: f32) -> Vec3 {
    let pitch = forward.y.clamp(-1.0, 1.0).asin();
    let heading = Vec3::new(forward.x, 0.0, forward.z).try_normalize().unwrap_or(Vec3::NEG_Z);
    let heading = Quat::from_rotation_y(-TURN * dx) * heading;
    let pitch = (pitch - TURN * dy).clamp(-STEEPEST, STEEPEST);
    heading * pitch.cos() + Vec3::Y * pitch.sin()
}

/// Rotates the camera about its own position (left drag): the picture follows the pointer.
pub fn turn(camera: &mut Camera, dx: f32, dy: f32) {
    let far = distance(camera);
    camera.target = camera.eye + far * rotated(camera.axes().forward, -dx, -dy);
}

/// Rotates the camera about its target (middle drag).
pub fn orbit(camera: &mut Camera, dx: f32, dy: f32) {
    let far = distance(camera);
    camera.eye = camera.target - far * rotated(camera.axes().forward, dx, dy);
}

/// Raises or lowers the camera (right drag). `dy` is the downward movement of the pointer divided by the height of the picture.
/// The camera moves in the same direction as the pointer, by this fraction of the height that is visible at the target.
pub fn raise(camera: &mut Camera, dy: f32) {
    let height = 2.0 * (0.5 * camera.field_of_view).tan() * distance(camera);
    let up = Vec3::Y * (-dy * height);
    camera.eye += up;
    camera.target += up;
}

/// Moves the camera horizontally for `seconds` (arrow keys).
pub fn walk(camera: &mut Camera, arrows: Arrows, seconds: f32) {
    let axes = camera.axes();
    let ahead = Vec3::new(axes.forward.x, 0.0, axes.forward.z).try_normalize().unwrap_or(Vec3::NEG_Z);
    let way = arrows.sign(Arrow::Up, Arrow::Down) * ahead + arrows.sign(Arrow::Right, Arrow::Left) * axes.right;
    let moved = way.normalize_or_zero() * (WALK * distance(camera) * seconds);
    camera.eye += moved;
    camera.target += moved;
}

/// Moves the camera towards its target, or away for negative `notches` (wheel).
pub fn zoom(camera: &mut Camera, notches: f32) {
    let forward = camera.axes().forward;
    let far = (distance(camera) * ZOOM.powf(notches)).clamp(1e-4, 1e7);
    camera.eye = camera.target - far * forward;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::new([0.0, 2.0, 10.0], [0.0, 2.0, 0.0])
    }

    #[track_caller]
    fn near(one: Vec3, other: [f32; 3]) {
        assert!((one - Vec3::from(other)).abs().max_element() < 1e-4, "{one}, expected {other:?}");
    }

    #[test]
    fn arrows_move_the_camera_horizontally() {
        let cases = [
            (Arrows::only(Arrow::Up), [0.0, 0.0, -7.0]),
            (Arrows::only(Arrow::Down), [0.0, 0.0, 7.0]),
            (Arrows::only(Arrow::Left), [-7.0, 0.0, 0.0]),
            (Arrows::only(Arrow::Right), [7.0, 0.0, 0.0]),
            (Arrows([false, false, true, true]), [0.0; 3]),
        ];
        for (arrows, moved) in cases {
            let mut moving = camera();
            walk(&mut moving, arrows, 1.0);
            near(moving.eye - camera().eye, moved);
            near(moving.target - camera().target, moved);
        }
        // Forwards is horizontal even if the camera looks down.
        let mut steep = Camera::new([0.0, 10.0, 10.0], [0.0; 3]);
        walk(&mut steep, Arrows::only(Arrow::Up), 1.0);
        assert_eq!(steep.eye.y, 10.0);
    }

    /// A drag to the right moves the picture to the right: the camera turns to the left.
    #[test]
    fn a_left_drag_rotates_the_camera_about_its_position() {
        let mut turning = camera();
        turn(&mut turning, 100.0, 0.0);
        near(turning.eye, [0.0, 2.0, 10.0]);
        near(turning.target, [-10.0 * 0.4_f32.sin(), 2.0, 10.0 - 10.0 * 0.4_f32.cos()]);
        turn(&mut turning, -100.0, 0.0);
        near(turning.target, [0.0, 2.0, 0.0]);
        turn(&mut turning, 0.0, 50.0);
        near(turning.target, [0.0, 2.0 + 10.0 * 0.2_f32.sin(), 10.0 - 10.0 * 0.2_f32.cos()]);
        turn(&mut turning, 0.0, 1e6);
        assert!(turning.axes().forward.y < 0.9999);
    }

    #[test]
    fn a_middle_drag_rotates_the_camera_about_its_target() {
        let mut turning = camera();
        orbit(&mut turning, 100.0, 50.0);
        near(turning.target, [0.0, 2.0, 0.0]);
        assert!((distance(&turning) - 10.0).abs() < 1e-4);
        assert!(turning.eye.x < -1.0 && turning.eye.y > 3.0, "{}", turning.eye);
    }

    #[test]
    fn a_right_drag_changes_the_height() {
        let mut rising = camera();
        raise(&mut rising, -0.5);
        let height = 10.0 * (0.5 * rising.field_of_view).tan();
        near(rising.eye, [0.0, 2.0 + height, 10.0]);
        near(rising.target, [0.0, 2.0 + height, 0.0]);
    }

    #[test]
    fn the_wheel_changes_the_distance_and_back() {
        let mut zooming = camera();
        zoom(&mut zooming, 3.0);
        near(zooming.eye, [0.0, 2.0, 10.0 * 0.88_f32.powi(3)]);
        near(zooming.target, [0.0, 2.0, 0.0]);
        zoom(&mut zooming, -3.0);
        near(zooming.eye, [0.0, 2.0, 10.0]);
        zoom(&mut zooming, 1e6);
        assert!(distance(&zooming) > 0.0);
    }
}
