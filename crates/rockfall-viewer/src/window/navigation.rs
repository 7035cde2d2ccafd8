//! Moves the camera with the arrow keys and the mouse. [`Limits`] keep the scene in the picture.

use rockfall::Scene;
use rockfall::glam::{Quat, Vec2, Vec3};

use crate::bounds::bounds_of_survey;
use crate::camera::{Camera, Up};
use crate::extent::extents_of_static_objects;
use crate::survey::Survey;

/// Rotation per pixel of a drag, in rad.
const TURN: f32 = 0.004;
/// Greatest pitch up or down, in rad. Straight up or down, left and right would be undefined.
const STEEPEST: f32 = 1.55;
/// Speed of the camera with the arrow keys, in distances of the target per second.
const WALK: f32 = 0.7;
/// Factor on the distance of the target per notch of the wheel.
const ZOOM: f32 = 0.88;
/// Size of half the picture in radii of a body, after a double click on it.
const FOCUS: f32 = 4.0;
/// Greatest distance of the camera from what it looks at, in radii of the scene.
const FARTHEST: f32 = 20.0;

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

/// Returns the unit vector of the horizontal part of a vector; `None` if that is 0.
fn horizontal(vector: Vec3, up: Up) -> Option<Vec3> {
    (vector - up.height(vector) * up.vector()).try_normalize()
}

/// Returns the viewing direction after a rotation by a drag of `dx`, `dy` pixels, with limited pitch.
fn rotated(camera: &Camera, dx: f32, dy: f32) -> Vec3 {
    let forward = camera.up.to_level(camera.axes().forward);
    let pitch = forward.y.clamp(-1.0, 1.0).asin();
    let heading = Vec3::new(forward.x, 0.0, forward.z).try_normalize().unwrap_or(Vec3::NEG_Z);
    let heading = Quat::from_rotation_y(-TURN * dx) * heading;
    let pitch = (pitch - TURN * dy).clamp(-STEEPEST, STEEPEST);
    camera.up.to_scene(heading * pitch.cos() + Vec3::Y * pitch.sin())
}

/// Rotates the camera about its own position (left drag): the picture follows the pointer.
pub fn turn(camera: &mut Camera, dx: f32, dy: f32) {
    let far = distance(camera);
    camera.target = camera.eye + far * rotated(camera, -dx, -dy);
}

/// Rotates the camera about its target (middle drag).
pub fn orbit(camera: &mut Camera, dx: f32, dy: f32) {
    let far = distance(camera);
    camera.eye = camera.target - far * rotated(camera, dx, dy);
}

/// Raises or lowers the camera (right drag). `dy` is the downward movement of the pointer divided by the height of the picture.
/// The camera moves in the same direction as the pointer, by this fraction of the height that is visible at the target.
pub fn raise(camera: &mut Camera, dy: f32) {
    let height = 2.0 * (0.5 * camera.field_of_view).tan() * distance(camera);
    let up = camera.up.vector() * (-dy * height);
    camera.eye += up;
    camera.target += up;
}

/// Moves the camera horizontally for `seconds` (arrow keys).
pub fn walk(camera: &mut Camera, arrows: Arrows, seconds: f32) {
    let axes = camera.axes();
    let ahead = horizontal(axes.forward, camera.up).unwrap_or_else(|| camera.up.to_scene(Vec3::NEG_Z));
    let way = arrows.sign(Arrow::Up, Arrow::Down) * ahead + arrows.sign(Arrow::Right, Arrow::Left) * axes.right;
    let moved = way.normalize_or_zero() * (WALK * distance(camera) * seconds);
    camera.eye += moved;
    camera.target += moved;
}

/// Moves the camera sideways (right drag). The point in the middle of the picture follows the pointer, which moves by this
/// fraction of the height of the picture to the right and down.
pub fn pan(camera: &mut Camera, moved: Vec2) {
    let axes = camera.axes();
    let height = 2.0 * (0.5 * camera.field_of_view).tan() * distance(camera);
    let moved = height * (moved.y * axes.up - moved.x * axes.right);
    camera.eye += moved;
    camera.target += moved;
}

/// Moves the camera by a number of notches of the wheel towards a point, or away from it for negative `notches`. The point stays
/// at the same place of the picture. The camera never passes it, and is at least `least` units in front of it. Afterwards the
/// camera orbits about a point at that depth.
pub fn zoom(camera: &mut Camera, notches: f32, point: Vec3, least: f32) {
    let forward = camera.axes().forward;
    let depth = (point - camera.eye).dot(forward);
    if depth <= 0.0 || !depth.is_finite() {
        return;
    }
    // A camera that is nearer than `least` already may move away, but not nearer.
    let factor = ZOOM.powf(notches).max((least / depth).min(1.0)).min(1e6);
    camera.eye = point + factor * (camera.eye - point);
    camera.target = camera.eye + factor * depth * forward;
}

/// Points the camera at a sphere, from the present direction, and moves it so near that the sphere fills a part of the picture
/// (double click).
pub fn focus(camera: &mut Camera, centre: Vec3, radius: f32) {
    let forward = camera.axes().forward;
    let near = FOCUS * radius / (0.5 * camera.field_of_view).tan();
    camera.target = centre;
    camera.eye = centre - near * forward;
}

/// Shows a whole bounding box from the present direction (key F). `aspect` is the width of the picture divided by its height.
pub fn frame_all(camera: &mut Camera, (min, max): (Vec3, Vec3), aspect: f32) {
    let radius = (0.5 * (max - min).length()).max(f32::MIN_POSITIVE);
    let half = 0.5 * camera.field_of_view;
    let narrow = half.min((half.tan() * aspect).atan());
    let forward = camera.axes().forward;
    camera.target = 0.5 * (min + max);
    camera.eye = camera.target - radius / narrow.sin() * forward;
}

/// Where the camera may be, so that the scene stays in sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Middle of the scene, in units.
    centre: Vec3,
    /// Distance from the middle to its farthest corner, in units.
    radius: f32,
    /// Least distance from the camera to what it looks at, in units.
    pub least: f32,
    /// Height below which the camera may not go: the bottom of all static objects.
    floor: Option<f32>,
}

impl Limits {
    /// Returns the limits for a scene in its present state, or in all states of a survey, with this axis upwards.
    pub fn of(scene: &Scene, survey: Option<&Survey>, up: Up) -> Self {
        let present = || bounds_of_survey(&Survey::with_up(scene, up), scene);
        let (min, max) = survey.map_or_else(present, |survey| bounds_of_survey(survey, scene));
        let radius = (0.5 * (max - min).length()).max(f32::MIN_POSITIVE);
        let smallest = scene.spheres().iter().map(|sphere| sphere.radius).fold(radius, f32::min);
        let floor = extents_of_static_objects(scene).map(|object| up.bottom(object)).reduce(f32::min);
        Self { centre: 0.5 * (min + max), radius, least: (0.5 * smallest).max(1e-4 * radius), floor }
    }

    /// Moves the camera back into the limits.
    pub fn keep(&self, camera: &mut Camera) {
        if !(camera.eye.is_finite() && camera.target.is_finite()) {
            let away = camera.up.to_scene(Vec3::new(0.4, 0.4, 0.8)) * (4.0 * self.radius);
            (camera.eye, camera.target) = (self.centre + away, self.centre);
        }
        // What the camera looks at must be near the scene.
        let mut target = self.centre + (camera.target - self.centre).clamp_length_max(self.radius);
        if let Some(floor) = self.floor {
            target += (floor - camera.up.height(target)).max(0.0) * camera.up.vector();
        }
        camera.eye += target - camera.target;
        camera.target = target;
        let forward = camera.axes().forward;
        let far = distance(camera).clamp(self.least, FARTHEST * self.radius.max(self.least));
        camera.eye = camera.target - far * forward;
        self.stay_above_the_floor(camera);
    }

    /// Raises the camera above the floor, at the same distance from what it looks at where that is possible.
    fn stay_above_the_floor(&self, camera: &mut Camera) {
        let Some(lowest) =
            self.floor.map(|floor| floor + 0.01 * self.radius).filter(|lowest| camera.up.height(camera.eye) < *lowest)
        else {
            return;
        };
        let far = distance(camera);
        let away = camera.eye - camera.target;
        let rise = lowest - camera.up.height(camera.target);
        let level = (far * far - rise * rise).max(0.0).sqrt();
        let aside = horizontal(away, camera.up).unwrap_or_else(|| camera.up.to_scene(Vec3::Z));
        camera.eye = camera.target + level * aside + rise * camera.up.vector();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Direction;

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

    const ASPECT: f32 = 1.5;

    /// Returns the position of a point in the picture: -1 to 1 from left to right and from bottom to top.
    fn place(camera: &Camera, point: Vec3) -> Vec2 {
        camera.view_projection(ASPECT).project_point3(point).truncate()
    }

    #[test]
    fn the_point_under_the_pointer_follows_a_right_drag() {
        let mut panning = Camera::new([3.0, 5.0, 9.0], [0.0, 1.0, 0.0]);
        // A tenth of the height to the right and a fifth down.
        pan(&mut panning, Vec2::new(0.1, 0.2));
        let moved = place(&panning, Vec3::Y);
        assert!((moved - Vec2::new(0.2 / ASPECT, -0.4)).length() < 1e-4, "{moved}");
    }

    #[test]
    fn the_wheel_moves_the_camera_to_the_point_under_the_pointer_and_back() {
        let point = Vec3::new(1.0, 2.5, 1.0);
        let mut zooming = camera();
        let before = place(&zooming, point);
        zoom(&mut zooming, 3.0, point, 0.1);
        assert!((place(&zooming, point) - before).length() < 1e-4);
        near(zooming.target, [zooming.eye.x, zooming.eye.y, 1.0]);
        assert!((distance(&zooming) - 9.0 * 0.88_f32.powi(3)).abs() < 1e-4);
        zoom(&mut zooming, -3.0, point, 0.1);
        near(zooming.eye, [0.0, 2.0, 10.0]);
    }

    #[test]
    fn zooming_never_passes_the_point_under_the_pointer() {
        let point = Vec3::new(0.5, 2.0, 3.0);
        let mut zooming = camera();
        for _ in 0..200 {
            zoom(&mut zooming, 2.0, point, 0.25);
        }
        assert!((zooming.eye.z - 3.25).abs() < 1e-4, "{}", zooming.eye);
        zoom(&mut zooming, 1e6, point, 0.25);
        zoom(&mut zooming, -1.0, point, 0.25);
        assert!(zooming.eye.is_finite() && zooming.eye.z > 3.25, "{}", zooming.eye);
    }

    #[test]
    fn a_focused_sphere_is_in_the_middle_and_fills_a_quarter_of_the_height() {
        let mut camera = camera();
        let centre = Vec3::new(4.0, 1.0, -3.0);
        focus(&mut camera, centre, 0.5);
        assert!(place(&camera, centre).length() < 1e-4);
        assert!((place(&camera, centre + 0.5 * camera.axes().up).y - 0.25).abs() < 1e-4);
    }

    #[test]
    fn a_framed_box_is_in_the_picture_from_every_direction() {
        let (min, max) = (Vec3::new(-9.0, 0.0, 2.0), Vec3::new(30.0, 1.0, 3.0));
        for eye in [[0.0, 2.0, 10.0], [50.0, 40.0, 30.0], [-8.0, 0.5, 2.5]] {
            let mut camera = Camera::new(eye, [0.0, 2.0, 0.0]);
            let forward = camera.axes().forward;
            frame_all(&mut camera, (min, max), ASPECT);
            assert!((camera.axes().forward - forward).length() < 1e-4);
            for corner in 0..8 {
                let pick = |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 1 { high } else { low };
                let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
                assert!(place(&camera, point).abs().max_element() <= 1.0, "{point}");
            }
        }
    }

    fn scene() -> Scene {
        let text = "S 1 0 3 0 0 0 0 0 0 0 1 0.5\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n";
        Scene::parse(text, std::path::Path::new("test")).unwrap().scene
    }

    /// Whatever the user does with the mouse, the ball or the floor below it is in the picture, and the camera is above the
    /// ground.
    #[test]
    fn no_movement_loses_the_scene() {
        let scene = scene();
        let limits = Limits::of(&scene, None, Up::Y);
        let mut camera = Camera::of_scene(&scene, ASPECT, Direction::Oblique);
        for step in 0..2000_u32 {
            // Long runs of the same movement, with a direction that changes.
            let kind = step / 40 * 7 % 6;
            let sign = if step / 160 % 2 == 0 { 1.0 } else { -1.0 };
            match kind {
                0 => orbit(&mut camera, 30.0 * sign, 20.0),
                1 => orbit(&mut camera, 10.0, -25.0 * sign),
                2 => pan(&mut camera, Vec2::new(0.3 * sign, 0.2)),
                3 => {
                    let target = camera.target;
                    zoom(&mut camera, 2.0 * sign, target, limits.least);
                }
                4 => turn(&mut camera, 30.0, 20.0 * sign),
                _ => walk(&mut camera, Arrows::only(Arrow::Up), 0.5),
            }
            limits.keep(&mut camera);
            assert!(camera.eye.is_finite() && camera.eye.y > -1.0, "{step}: {}", camera.eye);
            assert!(camera.target.distance(limits.centre) <= 1.01 * limits.radius, "{step}: {}", camera.target);
            let far = distance(&camera);
            assert!(far >= 0.9 * limits.least && far <= 1.1 * FARTHEST * limits.radius, "{step}: {far}");
        }
    }

    #[test]
    fn a_camera_within_the_limits_stays() {
        let scene = scene();
        let mut camera = Camera::of_scene(&scene, ASPECT, Direction::Oblique);
        let before = camera;
        Limits::of(&scene, None, Up::Y).keep(&mut camera);
        assert!(camera.eye.distance(before.eye) < 1e-4 && camera.target.distance(before.target) < 1e-4);
    }

    /// With another axis upwards, every movement is the same, turned.
    #[test]
    fn the_mouse_and_the_arrows_turn_with_the_axis_upwards() {
        let start = Camera::new([3.0, 4.0, 5.0], [-1.0, 0.5, 0.25]);
        let moves: [fn(&mut Camera); 6] = [
            |camera| turn(camera, 30.0, 20.0),
            |camera| orbit(camera, -30.0, 1e4),
            |camera| raise(camera, 0.2),
            |camera| pan(camera, Vec2::new(0.3, -0.2)),
            |camera| walk(camera, Arrows([true, false, true, false]), 0.5),
            |camera| {
                let floor = Limits { centre: Vec3::ZERO, radius: 9.0, least: 0.1, floor: Some(2.0) };
                orbit(camera, 9.0, -700.0);
                floor.keep(camera);
            },
        ];
        for up in [Up::X, Up::Z, Up::NegY] {
            for (number, go) in moves.iter().enumerate() {
                let mut level = start;
                let mut turned = Camera { eye: up.to_scene(start.eye), target: up.to_scene(start.target), up, ..start };
                go(&mut level);
                go(&mut turned);
                assert!(level != start, "{number}");
                near(up.to_level(turned.eye), level.eye.to_array());
                near(up.to_level(turned.target), level.target.to_array());
            }
        }
    }
}
