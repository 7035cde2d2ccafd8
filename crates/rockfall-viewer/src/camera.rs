//! The perspective camera.

use rockfall::Scene;
use rockfall::glam::{Mat4, Quat, Vec3, Vec4};

pub use crate::direction::Direction;
use crate::extent::Extent;
use crate::survey::Survey;
pub use crate::up::{Up, Vertical};

/// The default vertical field of view, in rad.
const FIELD_OF_VIEW: f32 = 0.6;
/// Distance of a camera that frames something, divided by the least distance.
const MARGIN: f32 = 1.12;
/// Distance of the near plane divided by the distance of the target.
const NEAR: f32 = 1e-3;

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the camera, in units.
    pub eye: Vec3,
    /// Point in the middle of the picture, in units; must differ from `eye`.
    pub target: Vec3,
    /// Vertical field of view in rad, greater than 0 and less than pi.
    pub field_of_view: f32,
    /// The axis that points to the top of the picture.
    pub up: Up,
}

/// Unit vectors of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// To the right of the picture.
    pub right: Vec3,
    /// To the top of the picture.
    pub up: Vec3,
    /// Into the picture.
    pub forward: Vec3,
}

impl Camera {
    /// Creates a camera at `eye` that looks at `target`; up is +y.
    pub fn new(eye: impl Into<Vec3>, target: impl Into<Vec3>) -> Self {
        Self { eye: eye.into(), target: target.into(), field_of_view: FIELD_OF_VIEW, up: Up::Y }
    }

    /// The camera of level coordinates in coordinates of the scene.
    fn with_up(self, up: Up) -> Self {
        Self { eye: up.to_scene(self.eye), target: up.to_scene(self.target), up, ..self }
    }

    /// Creates a camera that looks from a direction and shows the whole of a bounding box; `aspect` is the width of the picture
    /// divided by its height. Up is +y.
    pub fn framing(min: Vec3, max: Vec3, aspect: f32, from: Direction) -> Self {
        let middle = (min + max) * 0.5;
        let camera = Self::new(middle + from.to_camera(), middle);
        let Axes { right, up, forward } = camera.axes();
        let tangent = (0.5 * camera.field_of_view).tan();
        let half = (max - min) * 0.5;
        // The smallest distance at which every corner is within all four sides of the picture.
        let mut distance = 0.0_f32;
        for corner in 0..8 {
            let sign = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let offset = half * Vec3::new(sign(0), sign(1), sign(2));
            let across = (offset.dot(right).abs() / aspect).max(offset.dot(up).abs());
            distance = distance.max(across / tangent - offset.dot(forward));
        }
        let distance = if distance > 0.0 { MARGIN * distance } else { 1.0 };
        Self { eye: middle - distance * forward, ..camera }
    }

    /// Creates the camera nearest to some balls, given by centre and radius, that looks from a direction and shows all of them
    /// with a margin. `None` if there are no balls, or if they have no size.
    pub(crate) fn fitting(balls: &[(Vec3, f32)], aspect: f32, from: Direction) -> Option<Self> {
        let camera = Self::new(from.to_camera(), Vec3::ZERO);
        let Axes { right, up, forward } = camera.axes();
        let tangent = (0.5 * camera.field_of_view).tan();
        // For the sides of the picture along an axis: the place of the eye across, and how far forward it may be. A ball is
        // inside of a side if its centre is, and the side is moved inwards by the radius.
        let place = |axis: Vec3, tangent: f32| {
            let width = tangent.hypot(1.0);
            let [mut most, mut least] = [f32::NEG_INFINITY, f32::INFINITY];
            for (centre, radius) in balls {
                let (across, along) = (axis.dot(*centre), tangent * forward.dot(*centre));
                most = most.max(across + radius * width - along);
                least = least.min(across - radius * width + along);
            }
            (0.5 * (most + least), (least - most) / (2.0 * tangent))
        };
        let (x, wide) = place(right, aspect * tangent);
        let (y, high) = place(up, tangent);
        let extent = balls.iter().map(|(centre, radius)| Extent::around(*centre, *radius)).reduce(Extent::with)?;
        // The target is as far away as the middle of the balls, because the camera turns around it.
        let middle = forward.dot(0.5 * (extent.min + extent.max));
        let distance = MARGIN * (middle - wide.min(high));
        if !(distance.is_finite() && distance > 1e-5 * middle.abs()) {
            return None;
        }
        let target = x * right + y * up + middle * forward;
        Some(Self { eye: target - distance * forward, target, ..camera })
    }

    /// Creates a camera that shows the whole of a bounding box from all sides, when it orbits around its target. Up is +y.
    pub fn framing_all_around(min: Vec3, max: Vec3, aspect: f32, from: Direction) -> Self {
        let middle = 0.5 * (min + max);
        let half = 0.5 * (max - min);
        // The box around the box at every angle of its turn.
        let across = half.x.hypot(half.z);
        let half = Vec3::new(across, half.y, across);
        // A box with these corners is a little too large, because its turn is a cylinder.
        let wide = Self::framing(middle - half, middle + half, aspect, from);
        Self { eye: middle + 0.85 * (wide.eye - middle), ..wide }
    }

    /// Creates a camera that shows what the moving bodies of a scene do in all states of a survey, and what they lie on. With
    /// `all_around`, it does so from all sides.
    pub fn of_survey(survey: &Survey, scene: &Scene, aspect: f32, from: Direction, all_around: bool) -> Self {
        let up = survey.up();
        let (min, max) = crate::bounds::bounds_of_survey(survey, scene);
        let Extent { min, max } = up.level_extent(Extent { min, max });
        if all_around {
            return Self::framing_all_around(min, max, aspect, from).with_up(up);
        }
        let balls = crate::bounds::balls_to_show(survey, scene);
        let balls: Vec<_> = balls.into_iter().map(|(place, radius)| (up.to_level(place), radius)).collect();
        Self::fitting(&balls, aspect, from).unwrap_or_else(|| Self::framing(min, max, aspect, from)).with_up(up)
    }

    /// Returns the camera turned around the vertical through its target by an angle in rad. Seen from above, a positive angle
    /// moves it counterclockwise.
    pub fn orbited(self, angle: f32) -> Self {
        Self { eye: self.target + Quat::from_axis_angle(self.up.vector(), angle) * (self.eye - self.target), ..self }
    }

    /// Returns the camera moved back and up, so that what it showed leaves this part of the picture free at the upper edge.
    #[cfg_attr(target_family = "wasm", allow(dead_code, reason = "pictures with titles are native"))]
    pub(crate) fn with_room_above(self, part: f32) -> Self {
        let away = (self.eye - self.target) / (1.0 - part);
        let shift = part * away.length() * (0.5 * self.field_of_view).tan() * self.axes().up;
        Self { eye: self.target + away + shift, target: self.target + shift, ..self }
    }

    /// Returns the camera moved without turning it, so that it looks at another target.
    pub fn looking_at(self, target: Vec3) -> Self {
        Self { eye: self.eye + (target - self.target), target, ..self }
    }

    /// Creates a camera that looks from a direction and shows the moving bodies of a scene, what they lie on or may fall onto, and
    /// the places to which hanging bodies may swing. Up is opposite to gravity, as in [`Up::of`].
    pub fn of_scene(scene: &Scene, aspect: f32, from: Direction) -> Self {
        Self::of_scene_with_up(scene, Up::of(scene), aspect, from)
    }

    /// [`Camera::of_scene`] with another axis upwards.
    pub fn of_scene_with_up(scene: &Scene, up: Up, aspect: f32, from: Direction) -> Self {
        let (min, max) = crate::bounds::bounds_of_survey(&Survey::with_up(scene, up), scene);
        let shown = crate::bounds::room_to_swing(scene, up).fold(Extent { min, max }, Extent::with);
        let Extent { min, max } = up.level_extent(shown);
        Self::framing(min, max, aspect, from).with_up(up)
    }

    /// Returns the unit vectors of the camera.
    pub fn axes(&self) -> Axes {
        let forward = (self.target - self.eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        // When the camera looks straight down, the top of the picture is what is behind as seen from the front: -z for y up.
        let level = forward.cross(self.up.vector());
        let right = if level.length_squared() > 1e-10 { level.normalize() } else { self.up.to_scene(Vec3::X) };
        Axes { right, up: right.cross(forward), forward }
    }

    /// Distance of the near plane, in units; nothing nearer is drawn.
    pub fn near(&self) -> f32 {
        (NEAR * self.eye.distance(self.target)).max(f32::MIN_POSITIVE)
    }

    /// Matrix from world space to clip space: x to the right, y up, depth 1 on the near plane and 0 at infinity.
    pub fn view_projection(&self, aspect: f32) -> Mat4 {
        let Axes { right, up, forward } = self.axes();
        let scale = 1.0 / (0.5 * self.field_of_view).tan();
        let row = |axis: Vec3, scale: f32| (scale * axis).extend(-scale * axis.dot(self.eye));
        let rows = [row(right, scale / aspect), row(up, scale), Vec4::new(0.0, 0.0, 0.0, self.near()), row(forward, 1.0)];
        Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    }

    /// Returns the origin and the unit direction of the ray through a point of the picture. `ndc_x` is -1 at the left and 1
    /// at the right, `ndc_y` is -1 at the bottom and 1 at the top.
    pub fn ray(&self, ndc_x: f32, ndc_y: f32, aspect: f32) -> (Vec3, Vec3) {
        let Axes { right, up, forward } = self.axes();
        let tangent = (0.5 * self.field_of_view).tan();
        (self.eye, (forward + tangent * (aspect * ndc_x * right + ndc_y * up)).normalize())
    }
}

#[cfg(test)]
mod tests {
    use rockfall::{Cuboid, Rod, Sphere};

    use super::*;

    const ASPECT: f32 = 1.6;

    fn camera() -> Camera {
        Camera::new([3.0, 4.0, 5.0], [-1.0, 0.5, 0.25])
    }

    #[test]
    fn rays_and_projection_are_inverses() {
        let camera = camera();
        for (x, y) in [(0.0, 0.0), (0.9, -0.7), (-0.3, 0.8)] {
            let (origin, direction) = camera.ray(x, y, ASPECT);
            let ndc = camera.view_projection(ASPECT).project_point3(origin + 3.5 * direction);
            assert!((ndc.x - x).abs() < 1e-5 && (ndc.y - y).abs() < 1e-5, "{ndc}");
        }
    }

    #[test]
    fn room_above_leaves_the_upper_part_of_the_picture_free() {
        let camera = Camera::framing(-Vec3::ONE, Vec3::ONE, ASPECT, Direction::Front);
        let highest = |camera: Camera| {
            let projection = camera.view_projection(ASPECT);
            let corners =
                Extent { min: -Vec3::ONE, max: Vec3::ONE }.corners().map(|corner| projection.project_point3(corner).y);
            corners.fold((1.0_f32, -1.0_f32), |(least, most), y| (least.min(y), most.max(y)))
        };
        let (least, most) = highest(camera.with_room_above(0.1));
        assert!(highest(camera).1 > 0.8 && most < 0.75 && least > -1.0, "{least} {most}");
    }

    #[test]
    fn depth_is_near_over_distance() {
        let camera = camera();
        let Axes { forward, .. } = camera.axes();
        let at = |distance: f32| camera.view_projection(ASPECT).project_point3(camera.eye + distance * forward).z;
        assert!((at(camera.near()) - 1.0).abs() < 1e-3);
        assert!((at(2.0) * 2.0 - camera.near()).abs() < 1e-6);
    }

    #[test]
    fn axes_are_right_handed_and_up_points_upwards() {
        for target in [[-1.0, 0.5, 0.25], [3.0, 9.0, 5.0], [3.0, -9.0, 5.0]] {
            let Axes { right, up, forward } = Camera::new([3.0, 4.0, 5.0], target).axes();
            assert!((right.cross(up) + forward).length() < 1e-5);
            assert!(up.y >= -1e-6);
        }
    }

    #[test]
    fn a_box_framed_all_around_fits_the_picture_at_every_angle() {
        for (min, max) in [(Vec3::splat(-1.0), Vec3::ONE), (Vec3::new(-9.0, 0.0, 2.0), Vec3::new(30.0, 1.0, 3.0))] {
            for aspect in [0.5, 1.0, 2.5] {
                let mut greatest = 0.0_f32;
                for step in 0..36 {
                    let camera = Camera::framing_all_around(min, max, aspect, Direction::Oblique).orbited(step as f32 * 0.1745);
                    let projection = camera.view_projection(aspect);
                    for corner in 0..8 {
                        let pick = |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 1 { high } else { low };
                        let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
                        let ndc = projection.project_point3(point);
                        greatest = greatest.max(ndc.x.abs()).max(ndc.y.abs());
                    }
                }
                assert!((0.7..=1.0).contains(&greatest), "{min} {max} {aspect}: {greatest}");
            }
        }
    }

    #[test]
    fn balls_that_are_fitted_touch_the_edges_of_the_picture() {
        let balls: Vec<_> =
            (0..40).map(|k| (Vec3::new(k as f32, (k % 7) as f32, (k % 3) as f32), 0.1 * (k % 5) as f32)).collect();
        for aspect in [0.5, 1.0, 2.5] {
            let camera = Camera::fitting(&balls, aspect, Direction::Oblique).unwrap();
            let Axes { forward, .. } = camera.axes();
            let projection = camera.view_projection(aspect);
            let reach = |(centre, radius): &(Vec3, f32)| {
                let ndc = projection.project_point3(*centre);
                let size = radius / (0.5 * camera.field_of_view).tan() / forward.dot(*centre - camera.eye);
                (ndc.x.abs() + size / aspect).max(ndc.y.abs() + size)
            };
            let greatest = balls.iter().map(reach).fold(0.0, f32::max);
            assert!((0.7..=1.0).contains(&greatest), "{aspect}: {greatest}");
        }
        assert_eq!(Camera::fitting(&[], 1.0, Direction::Oblique), None);
        assert_eq!(Camera::fitting(&[(Vec3::ONE, 0.0)], 1.0, Direction::Oblique), None);
        // A thin row along the line of sight is nearer than its bounding box would allow.
        let row: Vec<_> = (0..30).map(|k| (Vec3::new(k as f32, 0.0, -(k as f32)), 0.5)).collect();
        let boxed = Camera::framing(Vec3::new(-0.5, -0.5, -29.5), Vec3::new(29.5, 0.5, 0.5), 1.6, Direction::Oblique);
        let fitted = Camera::fitting(&row, 1.6, Direction::Oblique).unwrap();
        assert!(fitted.eye.distance(fitted.target) < boxed.eye.distance(boxed.target));
    }

    #[test]
    fn a_framed_box_fits_the_picture_and_fills_it() {
        for (min, max) in [(Vec3::splat(-1.0), Vec3::ONE), (Vec3::new(-9.0, 0.0, 2.0), Vec3::new(30.0, 1.0, 3.0))] {
            for aspect in [0.5, 1.0, 2.5] {
                let projection = Camera::framing(min, max, aspect, Direction::Oblique).view_projection(aspect);
                let mut extent = 0.0_f32;
                for corner in 0..8 {
                    let pick = |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 1 { high } else { low };
                    let point = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
                    let ndc = projection.project_point3(point);
                    extent = extent.max(ndc.x.abs()).max(ndc.y.abs());
                }
                assert!((0.85..=1.0).contains(&extent), "{min} {max} {aspect}: {extent}");
            }
        }
    }

    /// A scene with a floor, a step, balls and a pendulum, turned so that this axis is up.
    fn scene(up: Up) -> Scene {
        let at = |x: f32, y: f32, z: f32| up.to_scene(Vec3::new(x, y, z));
        let mut scene = Scene::new();
        scene.settings.gravity_direction = -up.vector();
        for k in 0..5 {
            scene.add_sphere(Sphere::new(at(k as f32, 1.0 + 0.5 * k as f32, 0.3), 0.4)).unwrap();
        }
        let pivot = scene.add_sphere(Sphere::new(at(2.0, 6.0, 1.0), 0.1).fixed()).unwrap();
        let bob = scene.add_sphere(Sphere::new(at(4.0, 6.0, 1.0), 0.3)).unwrap();
        scene.add_rod(Rod::new(pivot, bob, 0.03)).unwrap();
        for (corner, size) in [(at(-9.0, -1.0, -9.0), at(18.0, 1.0, 18.0)), (at(5.0, 0.0, 0.0), at(1.0, 2.0, 1.0))] {
            scene.add_box(Cuboid::between(corner, corner + size)).unwrap();
        }
        scene
    }

    #[test]
    fn the_camera_turns_with_the_direction_of_gravity() {
        let same = |up: Up, turned: Camera, level: Camera| {
            assert_eq!(turned.up, up);
            let [eye, target] = [turned.eye, turned.target].map(|point| up.to_level(point));
            assert!(eye.distance(level.eye) + target.distance(level.target) < 1e-3, "{up:?}: {eye} {target} {level:?}");
            let (one, other) = (turned.axes(), level.axes());
            assert!(up.to_level(one.right).distance(other.right) + up.to_level(one.up).distance(other.up) < 1e-4, "{up:?}");
        };
        for up in [Up::X, Up::Z, Up::NegX, Up::NegY, Up::NegZ] {
            let [turned, level] = [up, Up::Y].map(scene);
            for from in [Direction::Oblique, Direction::Front, Direction::Side, Direction::Top] {
                let [one, other] = [&turned, &level].map(|scene| Camera::of_scene(scene, ASPECT, from));
                same(up, one, other);
                same(up, one.orbited(0.7), other.orbited(0.7));
                for all_around in [false, true] {
                    let of = |scene: &Scene, states: u32| {
                        let mut survey = Survey::new(scene);
                        (1..states).for_each(|_| survey.add(scene));
                        Camera::of_survey(&survey, scene, ASPECT, from, all_around)
                    };
                    (1..3).for_each(|states| same(up, of(&turned, states), of(&level, states)));
                }
            }
            let given = Camera::of_scene_with_up(&turned, Up::Y, ASPECT, Direction::Front);
            assert!(given.up == Up::Y && given.axes().up.distance(Vec3::Y) < 1e-6, "{given:?}");
        }
    }

    #[test]
    fn named_views_show_the_axes_and_the_whole_box() {
        let expected = [
            (Direction::Front, Vec3::X, Vec3::Y),
            (Direction::Side, Vec3::NEG_Z, Vec3::Y),
            (Direction::Top, Vec3::X, Vec3::NEG_Z),
        ];
        for (from, right, up) in expected {
            let camera = Camera::framing(Vec3::splat(-1.0), Vec3::ONE, ASPECT, from);
            let axes = camera.axes();
            assert!(axes.right.distance(right) < 1e-6 && axes.up.distance(up) < 1e-6, "{from:?} {axes:?}");
            let corner = camera.view_projection(ASPECT).project_point3(right + up + from.to_camera());
            assert!((0.85..1.0).contains(&corner.y), "{from:?} {corner}");
        }
        for from in Direction::NAMED {
            assert_eq!(Direction::named(from.name()), Ok(from));
        }
        assert_eq!(Direction::named("below").unwrap_err(), "expected one of: front, side, top, iso");
    }
}
