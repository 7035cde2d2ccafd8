//! Passages: spheres whose centre passes a wall within a step (docs/physics section 2.20).

use glam::Vec3;

use crate::fine::Fine;
use crate::model::layout::{DEEP_OVERLAP, FAST_WAY, OUTLINE_SLACK};
use crate::model::view::{Object, PolygonRecord, View};
use crate::scene::Surface;

/// Whether a moving sphere moves so far in a step that it may pass a wall before a deep contact was seen.
pub(crate) fn is_fast(view: &View, sphere: u32) -> bool {
    view.step.constants.dt * view.own_velocity(sphere).length() > FAST_WAY * view.radius(sphere)
}

/// Whether an overlap is so deep that the centre of a sphere may be near the wall.
pub(crate) fn is_deep(overlap: f32, radius: f32) -> bool {
    overlap >= DEEP_OVERLAP * radius
}

/// Whether a sphere passes a polygon on its way to the place where it is at the end of the step. Behind a parallelogram or a plane it
/// may come out again. A moving wall is where it is at the end of the step.
pub(crate) fn passes(view: &View, sphere: u32, way: Vec3, polygon: u32) -> bool {
    let object = Object::Polygon(polygon);
    let face = view.polygon(polygon);
    let now = Fine { high: view.position(sphere), low: Vec3::ZERO };
    let carried = view.wall(object).map_or(Vec3::ZERO, |wall| view.step.constants.dt * wall.velocity_at(now.high));
    let along = way - carried;
    passes_on_line(&face, (view.near_shape(object, now).high - face.corner) - along, along)
}

/// Whether a point that moves on a line passes a polygon. `before` is where it starts, as seen from the corner.
fn passes_on_line(face: &PolygonRecord, before: Vec3, along: Vec3) -> bool {
    let PolygonRecord { left, right, surface, .. } = *face;
    let normal = left.cross(right);
    let [above, after] = [before, before + along].map(|place| normal.dot(place));
    let is_two_sided = surface == Surface::Triangle;
    let meets = (above < 0.0) != (after < 0.0) && (is_two_sided || above >= 0.0);
    match surface {
        Surface::Cone { .. } | Surface::Ball { .. } => false,
        Surface::Plane => meets,
        Surface::Parallelogram | Surface::Triangle => {
            meets && {
                let place = before + above / (above - after) * along;
                let size = normal.length_squared();
                let [a, b] = [place.cross(right).dot(normal) / size, left.cross(place).dot(normal) / size];
                let farthest = if is_two_sided { a + b } else { a.max(b) };
                a.min(b) >= -OUTLINE_SLACK && farthest <= 1.0 + OUTLINE_SLACK
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places from which a point moves down by 1, and which polygons it passes: a parallelogram, a triangle, a plane.
    #[test]
    fn points_pass_within_the_outline() {
        let face = |surface| PolygonRecord { corner: Vec3::ZERO, left: Vec3::Z, right: Vec3::X, surface };
        let cases = [
            ([0.2, 0.5, 0.2], [true, true, true]),
            ([0.8, 0.5, 0.8], [true, false, true]),
            ([1.2, 0.5, 0.2], [false, false, true]),
            ([-0.1, 0.5, 0.2], [false, false, true]),
            ([0.2, 1.5, 0.2], [false, false, false]),
            ([0.2, -0.5, 0.2], [false, false, false]),
        ];
        for (place, expected) in cases {
            for (surface, expected) in [Surface::Parallelogram, Surface::Triangle, Surface::Plane].into_iter().zip(expected) {
                let (face, place) = (face(surface), Vec3::from_array(place));
                assert_eq!(passes_on_line(&face, place, -Vec3::Y), expected, "{place} {surface:?}");
                // From behind.
                let back = passes_on_line(&face, place - Vec3::Y, Vec3::Y);
                assert_eq!(back, expected && surface == Surface::Triangle, "{place} {surface:?}");
            }
        }
    }
}
